"""5. sightings -> World: what is where, how fast, and how sure.

A frame shows *that* something is somewhere; a track says *which* robot it is and where it is at any
instant. Theory of operation, files from the outside in:

``tracker``
    :class:`~vision_core.tracks.tracker.Tracker`, the only state of the stage: ``update`` with one frame's
    sightings, ``predict`` to any instant.
``robots``, ``ball``
    the lives of tracks: which sighting continues which track, what starts one, what ends it.
``assignment``
    one-to-one pairs of predictions and sightings within a gate.
``kalman``
    a constant-velocity Kalman filter.

Rules:

- A track's state stands at its last sighting. Every other instant is predicted from there, on demand;
  white-noise acceleration composes exactly, so frames without a sighting cost nothing and predicting
  twice is predicting once.
- Gates are metric where the filter is sure (``tracks.gate_m``) and statistical (three standard deviations)
  where it is not: after a gap, at a low frame rate, just after the start.
- Place decides before name. A robot that is read under another's number is still the robot that stood there;
  numbers change hands only after two readings.
- Nothing older than its validity leaves the stage.
"""
