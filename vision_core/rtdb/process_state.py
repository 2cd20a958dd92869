"""The states of a process and of a restart: set by the supervisor, read by whatever shows them.

Standard library only, as the supervisor is; its transitions are in ``app.supervisor.lifecycle``.
"""

from enum import StrEnum


class ProcessState(StrEnum):
    """What the supervisor does with a process."""

    WAITING = "waiting"
    """It was not started yet."""
    STARTING = "starting"
    """It was started and has not written its first heartbeat."""
    RUNNING = "running"
    RESTARTING = "restarting"
    """It has ended and is started again soon."""
    DISABLED = "disabled"
    """It has crashed too often and stays off until somebody asks for it: ``pslv restart NAME``."""
    DONE = "done"
    """It runs once and has ended well."""
    STOPPED = "stopped"
    """The service ends."""


SETTLED = frozenset({ProcessState.RUNNING, ProcessState.DONE, ProcessState.DISABLED})
"""States that do not change by themselves."""


class RestartState(StrEnum):
    """What became of the newest request to restart the whole service."""

    NONE = "none"
    """There was none since the start or the last restart."""
    CHECKING = "checking"
    """Whether the service would start is being found out; it goes on meanwhile."""
    REFUSED = "refused"
    """It would not start, so it goes on as it is."""
    RESTARTING = "restarting"
