"""One session: its transitions, and the diagram of them in docs/protocol.md."""

import re
from collections import defaultdict
from pathlib import Path

from vision_core.protocol.lifecycle import TRANSITIONS, SessionState, SessionTrigger

PAGE = (Path(__file__).parents[2] / "docs" / "protocol.md").read_text(encoding="utf-8")


def test_an_open_session_can_be_closed_and_a_closed_one_stays_closed() -> None:
    ends = {
        SessionTrigger.REFUSED,
        SessionTrigger.LEFT,
        SessionTrigger.SILENT,
        SessionTrigger.REPLACED,
        SessionTrigger.STOPPED,
    }
    for state in SessionState:
        for trigger in SessionTrigger:
            after = TRANSITIONS.get((state, trigger), state)
            if state is SessionState.CLOSED or trigger in ends:
                assert after is SessionState.CLOSED


def test_every_state_is_reached_by_a_transition_or_is_the_first() -> None:
    assert {*TRANSITIONS.values(), SessionState.TRYING} == set(SessionState)


def diagram() -> str:
    """The table of transitions as a diagram of Mermaid: an arrow from state to state, with its triggers."""
    arrows = defaultdict(list)
    for (before, trigger), after in TRANSITIONS.items():
        arrows[before, after].append(trigger)
    lines = [
        f"    {before} --> {after}: {', '.join(sorted(triggers))}"
        for (before, after), triggers in sorted(arrows.items())
    ]
    first, last = f"    [*] --> {SessionState.TRYING}: init", f"    {SessionState.CLOSED} --> [*]"
    return "\n".join(["stateDiagram-v2", first, *lines, last])


def test_the_pages_diagram_is_the_table() -> None:
    shown = re.search(r"```mermaid\n(.*?)\n?```", PAGE, flags=re.DOTALL)
    assert shown is not None
    assert shown[1] == diagram()
