"""Everything round the core: command line, supervisor, web process.

Files, outside-in: ``main`` (entry), ``cli`` (commands), ``service_plan`` (settings -> what to start),
``supervisor/`` (starts and watches), ``web_process`` (the page's process), ``server`` and ``routes/``
(HTTP), ``live`` (WebSocket), ``readiness`` (is the service ready, and why not).
"""

from importlib.metadata import version

__version__ = version("pslv")
