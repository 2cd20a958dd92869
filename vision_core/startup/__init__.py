"""The main modules of the service's processes.

``preflight`` (can the tasks work with these settings?), ``calibrate`` (the camera, its lens, or a robot's mirror; with
``mirror_pairs``), ``set_up`` (a step of a new venue), ``compile`` (every kernel, once), ``process`` (the tasks of the
table that name it), ``responder`` (tells clients that the server is not ready), ``log_reader`` (prints and keeps what
the others print; with ``log_book`` and ``process_names``), ``spare`` (has loaded everything and waits to take the place
of a process).

They are started by name, ``python -m NAME``, and never imported by what starts them: each loads more than the process
that starts it needs. So their names stand here.
"""

CALIBRATE, COMPILE, LOG_READER, PREFLIGHT, PROCESS, RESPONDER, SET_UP, SPARE = (
    f"{__name__}.{name}"
    for name in ("calibrate", "compile", "log_reader", "preflight", "process", "responder", "set_up", "spare")
)
WITHOUT_SOURCE = "--without-source"
"""Argument of PREFLIGHT: do not open the source."""
