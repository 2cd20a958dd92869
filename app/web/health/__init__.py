"""How well the service serves robots: ready, degraded with its causes, or not ready with its reasons.

``cause`` defines one cause with its advice. ``readiness`` lists what keeps robots from being served; each of
``processes``, ``rights``, ``rates``, ``losses`` and ``sightings`` lists the causes of worse service of its subject.
``frame_path`` finds the tasks that every frame passes. All of them are pure functions of one ``ServiceSnapshot``, but
for the counts of a minute in ``losses``. ``hysteresis`` reports a measured
cause only when it lasts, ``monitor`` combines everything into one ``Health`` for /readyz, /metrics, the status, the
page and the log, and ``log`` prints changes of the state.
"""
