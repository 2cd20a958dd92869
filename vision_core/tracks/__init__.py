"""5. Sightings -> World: where each robot, the ball and the obstacles are, how fast they move, and how certain that is.

A sighting says that something is at a position in one frame. A track connects the sightings of one object over time:
it says *which* robot it is, and where it is at any instant. Theory of operation, files from the outside in:

``tracker``
    :class:`~vision_core.tracks.tracker.Tracker`, the only state of the stage: ``update`` with the sightings of one
    frame, ``predict`` to any instant. Each is one compiled call: ``update_tracks`` and ``write_world``.
``robot_tracks``, ``ball_tracks``, ``obstacle_tracks``
    which sighting continues which track, what starts a track, what ends it.
``pairing``
    one-to-one pairs of predicted tracks and sightings within a gate.
``filters``
    a constant-velocity Kalman filter.
``state``
    the tracker's memory and its parameters, as tables.

Rules:

- A track's state holds at its last sighting. Every other instant is predicted from there, on demand;
  white-noise acceleration composes exactly, so frames without a sighting cost nothing, and predicting
  in two steps gives what predicting in one step gives.
- A sighting is weighted by its variance: its own, plus that of the calibration (``tracks.robot_noise_m``,
  ``tracks.heading_noise_rad``, ``tracks.ball_noise_m``).
- Gates are metric (``tracks.gate_m``) while the filter is certain, and statistical (three standard deviations)
  while it is not: after a gap, at a low frame rate, just after the start.
- An obstacle is assumed to keep its velocity (a new one: to stand still) until a maneuver is detected: a sighting
  farther from the prediction than noise explains. Then its velocity becomes uncertain again.
- Position decides before id. A robot whose id is read wrongly is still the robot that was there;
  a track changes its id only after eight readings in a row.
- Nothing older than its validity is written to a world.
"""
