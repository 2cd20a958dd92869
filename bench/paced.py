"""The whole loop and the classic segmentation alone on frames that come at 30 Hz, in a process as ``perceive`` is one.

    python -m bench.paced SIZE ROBOTS

Between two frames the caches are lost to other work, so every frame takes longer than back to back. The process has the
real-time priority of ``perceive`` where that is granted; another one copies each frame into the ring of frames just
before it publishes it (``paced_camera``). The methods take turns in blocks of frames: the loop, the loop that rehearses
between frames and then watches for the next as the service does, and the classic segmentation alone, in Python and in
C. What is timed begins when the frame is published, and ends when its last datagram is sent, or its last blob found.

Prints JSON: the scheduling policies, the counts of rehearsals, and for each method its times [us].
"""

import contextlib
import json
import os
import select
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from bench.helpers import Helper, request_realtime
from bench.paced_camera import frame_record
from bench.segmentation import c_reference_of
from bench.segmenters import ReferenceSegmenter
from bench.whole_loop import BLOCK, UNMEASURED, Loop, open_loop
from vision_core.clock import NS_PER_S, NS_PER_US, Instant, MonotonicClock, seconds_between
from vision_core.geometry import Bytes
from vision_core.rtdb.slots import SlotReader, SlotView
from vision_core.rtdb.store import Store, create_block
from vision_core.scheduling.rehearser import Part, Rehearser
from vision_core.scheduling.releases import Trigger

LOOP, REHEARSED = "loop", "loop that rehearses"
REFERENCE, IN_C = "reference segmentation", "reference segmentation in C"
METHODS = (REHEARSED, REFERENCE, LOOP, IN_C)
TURNS = 10
"""Blocks of each method."""
PATIENCE_S = 1.0

Method = Callable[[SlotView], object]
"""Processes a frame in the ring."""


@dataclass(frozen=True, slots=True)
class Frames:
    """The frames that the camera's process publishes."""

    reader: SlotReader
    event: int
    trigger: Trigger
    shape: tuple[int, int, int]
    rehearser: Rehearser
    part: Part
    """The rehearsal of the loop."""

    def wait(self, *, rehearses: bool) -> SlotView:
        """The next frame; until it comes the process sleeps, or rehearses and watches.

        Raises RuntimeError when none comes within PATIENCE_S.
        """
        clock = MonotonicClock()
        end = Instant(clock.now() + round(PATIENCE_S * NS_PER_S))
        while (now := clock.now()) < end:
            if (release := self.trigger.take(now)) is not None:
                view = self.reader.view()
                assert view is not None
                self.rehearser.released(release.due)
                return view
            begin = self.rehearser.begin(now, [self.part]) if rehearses else None
            if begin is None or begin > now:
                self._sleep(seconds_between(now, begin or end))
            else:
                self._watch(self.rehearser.rehearse([self.part], self._is_released))
        raise RuntimeError(f"no frame came for {PATIENCE_S:g} s")

    def pixels(self, view: SlotView) -> Bytes:
        """Of a frame, in the ring."""
        return np.frombuffer(view.payload.toreadonly(), dtype=np.uint8).reshape(self.shape)

    def _sleep(self, timeout_s: float) -> None:
        ready, _, _ = select.select([self.event], [], [], timeout_s)
        if ready:
            os.eventfd_read(self.event)

    def _watch(self, until: Instant) -> None:
        while MonotonicClock().now() < until and not self._is_released():
            pass

    def _is_released(self) -> bool:
        return self.trigger.is_due(MonotonicClock().now())


def main(size: str, robots: int) -> None:
    """Measure one case."""
    with open_loop(size, robots) as loop, _frames_of(loop, size, robots) as (frames, camera):
        methods = _methods(loop, frames)
        for method in methods.values():
            method(frames.wait(rehearses=False))  # loads the kernels
        policy = request_realtime(loop.settings.tasks["perceive"].times.priority)
        times = _measure(methods, frames, loop)
        policies = f"{policy}, camera {camera.finish()['policy']}"
        print(json.dumps({"policies": policies, "rehearsals": str(frames.part.counts), "times_us": times}))


@contextlib.contextmanager
def _frames_of(loop: Loop, size: str, robots: int) -> Iterator[tuple[Frames, Helper]]:
    """The ring of frames, and the process that fills it."""
    size_px = loop.perception.camera.size_px
    record = frame_record(size_px)
    block, event = create_block([record]), os.eventfd(0, os.EFD_NONBLOCK)
    reader = Store([record], block, read_only=True).reader(record.name)
    trigger, rehearser = Trigger(reader, Instant(0), 0.0), Rehearser(MonotonicClock())
    frames = Frames(reader, event, trigger, loop.perception.camera.shape, rehearser, Part(loop.rehearse))
    try:
        with Helper("bench.paced_camera", size, robots, block, event, descriptors=(block, event)) as camera:
            yield frames, camera
    finally:
        os.close(block)
        os.close(event)


def _methods(loop: Loop, frames: Frames) -> dict[str, Method]:
    """What is timed, by name; without a compiler there is none in C."""
    table, settings = loop.perception.table, loop.settings
    reference = ReferenceSegmenter(*loop.perception.camera.size_px, settings.blobs)

    def turn(view: SlotView) -> object:
        return loop.turn(frames.pixels(view), view.measured)

    methods: dict[str, Method] = dict.fromkeys((LOOP, REHEARSED), turn)
    methods[REFERENCE] = lambda view: reference.segment(frames.pixels(view), table)
    slots = [
        np.frombuffer(frames.reader.payload(slot), dtype=np.uint8).reshape(frames.shape)
        for slot in range(frames.reader.spec.slots)
    ]
    in_c, _ = c_reference_of(settings, table, slots)
    if in_c is not None:
        methods[IN_C] = lambda view: in_c[0](view.sequence % len(slots))
    return {name: methods[name] for name in METHODS if name in methods}


def _measure(methods: dict[str, Method], frames: Frames, loop: Loop) -> dict[str, list[float]]:
    """Times of each method [us], from the publication of a frame."""
    now = MonotonicClock().now
    times: dict[str, list[float]] = {name: [] for name in methods}
    for _ in range(TURNS):
        for name, method in methods.items():
            for place in range(BLOCK):
                view = frames.wait(rehearses=name == REHEARSED)
                began = now()
                method(view)
                ended = now()
                took_ns = ended - view.written
                if name in (LOOP, REHEARSED):
                    frames.rehearser.ran(ended - began)
                loop.drain()
                if place >= UNMEASURED:
                    times[name].append(took_ns / NS_PER_US)
    return times


if __name__ == "__main__":
    main(sys.argv[1], int(sys.argv[2]))
