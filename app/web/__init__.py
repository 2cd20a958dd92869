"""The web process: page, API and live connection. It reads the real-time database and knows no stage.

``process`` (main), ``application`` (FastAPI), ``blackboard`` (all records, read at one instant), ``health/`` (ready,
degraded or not ready), ``reports/`` (what the API reports, one module per subject), ``routes/`` (HTTP), ``live/``
(WebSocket), ``middleware/`` (which requests are refused), ``overrides`` (changes of tasks while the service runs),
``heartbeat``, ``metrics`` (Prometheus), ``problems`` (errors as problem details).
"""

PROCESS = f"{__name__}.process"
"""Main module of the process; its name alone, since only that process imports it."""
