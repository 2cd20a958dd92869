"""The order in which a frame's datagrams are sent: a new one for every frame, and any of them can be found again.

The order follows from the record's seed and from the frame's Time alone (docs/protocol.md, "Fairness"): the robots that
are sent a view, blue before yellow and by number, are shuffled with random numbers that begin anew for each frame. So
whoever knows the seed, the Time and the robots finds the order without replaying the match.
"""

import numpy as np
from numpy.typing import NDArray

from vision_core.native.kernels import kernel

GOLDEN, FIRST, SECOND = 0x9E3779B97F4A7C15, 0xBF58476D1CE4E5B9, 0x94D049BB133111EB
"""Constants of splitmix64."""
STAR = 0x2545F4914F6CDD1D
"""Multiplier of xorshift64*."""


@kernel
def frame_state(seed: np.uint64, time_us: int) -> np.uint64:
    """State of the random generator for the frame of a Time [us]: splitmix64 of the seed; never 0."""
    state = seed + np.uint64(time_us) * np.uint64(GOLDEN)
    state = (state ^ (state >> np.uint64(30))) * np.uint64(FIRST)
    state = (state ^ (state >> np.uint64(27))) * np.uint64(SECOND)
    return (state ^ (state >> np.uint64(31))) | np.uint64(1)


@kernel
def shuffle(order: NDArray[np.int64], count: int, seed: np.uint64, time_us: int) -> None:
    """Shuffle the first ``count`` places for the frame of a Time [us]: Fisher-Yates, with numbers of xorshift64*."""
    state = frame_state(seed, time_us)
    for last in range(count - 1, 0, -1):
        state ^= state >> np.uint64(12)
        state ^= state << np.uint64(25)
        state ^= state >> np.uint64(27)
        drawn = (state * np.uint64(STAR)) >> np.uint64(32)
        other = np.int64(drawn * np.uint64(last + 1) >> np.uint64(32))
        order[last], order[other] = order[other], order[last]
