"""The order of sending: found again from the seed and the Time by whoever reads docs/protocol.md."""

import numpy as np
import pytest

from vision_core.net.sending_order import shuffle

WORD = (1 << 64) - 1


def order_by_the_protocol(seed: int, time_us: int, count: int) -> list[int]:
    """As docs/protocol.md says it, in integers of Python."""
    state = (seed + time_us * 0x9E3779B97F4A7C15) & WORD
    state = ((state ^ state >> 30) * 0xBF58476D1CE4E5B9) & WORD
    state = ((state ^ state >> 27) * 0x94D049BB133111EB) & WORD
    state = (state ^ state >> 31) | 1
    order = list(range(count))
    for last in range(count - 1, 0, -1):
        state ^= state >> 12
        state = (state ^ state << 25) & WORD
        state ^= state >> 27
        drawn = (state * 0x2545F4914F6CDD1D & WORD) >> 32
        other = drawn * (last + 1) >> 32
        order[last], order[other] = order[other], order[last]
    return order


@pytest.mark.parametrize("seed", [0, 1, 0x0123456789ABCDEF, WORD])
@pytest.mark.parametrize("time_us", [0, 33_333, 20_306_148_000, 1 << 52])
def test_the_order_is_that_of_the_protocol(seed: int, time_us: int) -> None:
    for count in (1, 2, 10, 32):
        order = np.arange(count)
        shuffle(order, count, np.uint64(seed), time_us)
        assert order.tolist() == order_by_the_protocol(seed, time_us, count)


def test_neighboring_frames_have_independent_orders() -> None:
    frames, count = 20_000, 5
    seen = np.zeros((count, count), dtype=int)
    for frame in range(frames):
        first = order_by_the_protocol(42, 33_333 * frame, count)[0]
        seen[first, order_by_the_protocol(42, 33_333 * (frame + 1), count)[0]] += 1
    expected = frames / count**2
    assert ((seen - expected) ** 2 / expected).sum() < 51.2  # 24 degrees of freedom: one in a thousand seeds
