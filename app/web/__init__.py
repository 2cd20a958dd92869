"""The web process: page, API and live connection. It reads the real-time database and knows no stage.

``process`` (main), ``application`` (FastAPI), ``blackboard`` (all records, read at one instant), ``health/`` (ready,
degraded or not ready), ``reports/`` (what the API reports, one module per subject), ``routes/`` (HTTP), ``live/``
(WebSocket), ``middleware/`` (which requests are refused), ``auth/`` (who somebody is), ``configuration/`` (the one door
for changes), ``storage/`` (where they are kept), ``calibration/`` (of the camera, by a process of its own),
``fairness/`` (the impartiality report), ``charts/`` (pictures of figures), ``view3d/``, ``support/`` (the support
bundle), ``heartbeat``, ``metrics`` (Prometheus), ``problems`` (errors as problem details).
"""

PROCESS = f"{__name__}.process"
"""Main module of the process; its name alone, since only that process imports it."""
