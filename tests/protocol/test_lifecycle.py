"""One session: its transitions, and its form as plain data."""

from vision_core.protocol.lifecycle import TRANSITIONS, SessionState, SessionTrigger


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
