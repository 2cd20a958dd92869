"""The web process: page, API and live connection. It reads the real-time database and knows no stage.

``process`` (main), ``application`` (FastAPI), ``blackboard`` (all records, read at one instant), ``reports/`` (what is
told about each subject), ``routes/`` (HTTP), ``live/`` (WebSocket), ``middleware/`` (who may do what), ``overrides``
(what operators change), ``heartbeat``, ``metrics`` (Prometheus), ``problems`` (errors as problem details).
"""

PROCESS = f"{__name__}.process"
"""Main module of the process; its name alone, since only that process imports it."""
