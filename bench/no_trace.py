"""Rehearsals leave no trace: datagrams with them and without are the same, byte for byte.

Two pipelines in one process (``whole_loop``) with the same seed of the order of sending play the same frames of a
simulated match, 640x480 with 10 robots, looped; one frame in 97 is dark, so that all robots are lost and found again.
One pipeline rehearses before each frame; before every third it first gives way, each time at another stage. After each
frame the datagrams of all clients are compared, and whatever the next frames depend on: sightings, what is expected,
tracks, counters and the order of sending.
"""

import itertools
from dataclasses import dataclass

from bench.helpers import with_progress
from bench.runner import Row
from bench.whole_loop import Loop, match_frames, open_loop
from vision_core.geometry import Bytes
from vision_core.scheduling.rehearser import GiveWay

SIZE, ROBOTS = "640x480", 10
DARK_EVERY, GIVES_WAY_EVERY = 97, 3
STAGES = 5
"""Times that a rehearsal asks whether it must give way."""


@dataclass(slots=True)
class Counts:
    """What was compared."""

    datagrams: int = 0
    other_datagrams: int = 0
    """Frames whose datagrams differ."""
    other_states: int = 0
    """Frames after which the state differs."""
    whole: int = 0
    """Rehearsals."""
    gave_way: int = 0


def run(frames: int = 100_000) -> list[Row]:
    """Play so many frames."""
    pictures = match_frames(SIZE, ROBOTS)
    with open_loop(SIZE, ROBOTS) as plain, open_loop(SIZE, ROBOTS) as rehearsing:
        counts = play(plain, rehearsing, pictures, frames)
    return [
        {"name": "frames", "value": frames},
        {"name": "rehearsals", "value": counts.whole},
        {"name": "rehearsals that gave way", "value": counts.gave_way},
        {"name": "datagrams that were compared", "value": counts.datagrams},
        _none("frames with other datagrams", counts.other_datagrams),
        _none("frames after which the state is another", counts.other_states),
    ]


def play(plain: Loop, rehearsing: Loop, pictures: list[Bytes], frames: int) -> Counts:
    """Play pictures to both pipelines, shape (height, width, 3) each."""
    counts, dark = Counts(), pictures[0] * 0
    stages = itertools.cycle(range(STAGES))
    for number in with_progress(range(frames), "no_trace"):
        if number and number % GIVES_WAY_EVERY == 0:
            counts.gave_way += not rehearsing.rehearse(_gives_way_at(next(stages)))
        counts.whole += rehearsing.rehearse(lambda: False)
        pixels = dark if number % DARK_EVERY == DARK_EVERY - 1 else pictures[number % len(pictures)]
        datagrams = []
        for loop in (plain, rehearsing):
            loop.turn(pixels)
            datagrams.append(loop.received())
        counts.datagrams += len(datagrams[0])
        counts.other_datagrams += datagrams[0] != datagrams[1]
        counts.other_states += plain.state() != rehearsing.state()
    return counts


def _gives_way_at(stage: int) -> GiveWay:
    """Answers no so many times, then yes."""
    answers = itertools.chain(itertools.repeat(False, stage), itertools.repeat(True))
    return lambda: next(answers)


def _none(name: str, count: int) -> Row:
    return {"name": name, "value": count, "goal": "0", "met": count == 0}
