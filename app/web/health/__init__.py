"""How well the service serves robots: ready, degraded with its causes, or not ready with its reasons.

``readiness`` lists what keeps robots from being served. ``degradation`` defines one cause of worse service; each of
``processes``, ``rights``, ``rates`` and ``sightings`` lists the causes of its subject. ``frame_path`` finds the tasks
that every frame passes. All of them are pure functions of one ``ServiceSnapshot``. ``hysteresis`` reports a measured
cause only when it lasts, ``monitor`` combines everything into one ``Health`` for /readyz, /metrics, the status, the
page and the log, and ``log`` prints changes of the state.
"""
