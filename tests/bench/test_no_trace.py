"""What a rehearsal changed would be found: in the datagrams, or in the state."""

import pytest

from bench.no_trace import STAGES, play
from bench.whole_loop import Loop, match_frames, open_loop
from vision_core.geometry import Bytes

FRAMES = 40

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def pictures() -> list[Bytes]:
    return match_frames("640x480", 10)[:FRAMES]


def test_rehearsals_leave_no_trace(pictures: list[Bytes]) -> None:
    with open_loop("640x480", 10) as plain, open_loop("640x480", 10) as rehearsing:
        counts = play(plain, rehearsing, pictures, FRAMES)
    assert (counts.whole, counts.gave_way) == (FRAMES - 1, (FRAMES - 1) // 3)
    assert counts.gave_way > STAGES, "at each stage"
    assert counts.datagrams > FRAMES
    assert (counts.other_datagrams, counts.other_states) == (0, 0)


def test_a_trace_is_found(pictures: list[Bytes]) -> None:
    class Careless(Loop):
        def rehearse(self, give_way: object) -> bool:
            self.perception.context.segment.cursor[0] += 1
            return True

    with open_loop("640x480", 10) as plain, open_loop("640x480", 10) as other:
        other.__class__ = Careless
        counts = play(plain, other, pictures, 10)
    assert counts.other_states == 10
