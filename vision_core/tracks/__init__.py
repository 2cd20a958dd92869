"""5. sightings -> World: what is where, how fast, and how sure.

A frame shows *that* something is somewhere; a track says *which* robot it is and where it is at any
instant. Theory of operation, files from the outside in:

``tracker``
    :class:`~vision_core.tracks.tracker.Tracker`, the only state of the stage: ``update`` with one frame's
    sightings, ``predict`` to any instant. Each is one compiled call, ``follow`` and ``tell``.
``robot_lives``, ``ball_lives``, ``obstacle_lives``
    the lives of tracks: which sighting continues which track, what starts one, what ends it.
``pairing``
    one-to-one pairs of predictions and sightings within a gate.
``filters``
    a constant-velocity Kalman filter.
``state``
    what is remembered, and the rules, as tables.

Rules:

- A track's state stands at its last sighting. Every other instant is predicted from there, on demand;
  white-noise acceleration composes exactly, so frames without a sighting cost nothing and predicting
  twice is predicting once.
- A sighting weighs as much as it is sure: by its own standard deviation, and by what the calibration's errors
  add to it (``tracks.robot_noise_m`` and its like, in quadrature).
- Gates are metric where the filter is sure (``tracks.gate_m``) and statistical (three standard deviations)
  where it is not: after a gap, at a low frame rate, just after the start.
- An obstacle is thought at rest, or to go on as it goes, until a sighting startles: then its velocity is free again.
- Place decides before name. A robot that is read under another's number is still the robot that stood there;
  numbers change hands only after two readings.
- Nothing older than its validity leaves the stage.
"""
