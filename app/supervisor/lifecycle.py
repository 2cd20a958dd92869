"""The life of a process: its states, what changes them, and every transition as a table."""

from collections.abc import Mapping
from enum import StrEnum
from types import MappingProxyType

from vision_core.rtdb.process_state import ProcessState


class Change(StrEnum):
    """What happens to a process."""

    STARTED = "started"
    """It was started, or a warm spare has taken its place."""
    HEARTBEAT = "heartbeat"
    """It has written its first heartbeat."""
    FINISHED = "finished"
    """It ran once and ended with exit status 0."""
    CRASHED = "crashed"
    """It ended unasked, or could not be started, and is tried again."""
    GIVEN_UP = "given_up"
    """It crashed once too often, or may run only once."""
    RE_ENABLED = "re_enabled"
    """Somebody asked for a disabled process."""
    HANDED_OVER = "handed_over"
    """A warm spare has become another process: its own place is empty."""
    STOPPED = "stopped"
    """The service ends."""


_STARTABLE = (ProcessState.WAITING, ProcessState.RESTARTING)
_ALIVE = (ProcessState.STARTING, ProcessState.RUNNING)

TRANSITIONS: Mapping[tuple[ProcessState, Change], ProcessState] = MappingProxyType(
    {(state, Change.STARTED): ProcessState.STARTING for state in _STARTABLE}
    | {(state, Change.CRASHED): ProcessState.RESTARTING for state in (*_STARTABLE, *_ALIVE)}
    | {(state, Change.GIVEN_UP): ProcessState.DISABLED for state in (*_STARTABLE, *_ALIVE)}
    | {(state, Change.FINISHED): ProcessState.DONE for state in _ALIVE}
    | {(state, Change.STOPPED): ProcessState.STOPPED for state in ProcessState}
    | {
        (ProcessState.STARTING, Change.HEARTBEAT): ProcessState.RUNNING,
        (ProcessState.RUNNING, Change.HANDED_OVER): ProcessState.WAITING,
        (ProcessState.DISABLED, Change.RE_ENABLED): ProcessState.RESTARTING,
    }
)


def next_state(state: ProcessState, change: Change) -> ProcessState:
    """The state after a change. Raises ValueError for a change that the table does not have in this state."""
    try:
        return TRANSITIONS[state, change]
    except KeyError:
        possible = ", ".join(known for at, known in TRANSITIONS if at == state)
        raise ValueError(f"a process that is {state}: {change} was found, {possible} is accepted") from None
