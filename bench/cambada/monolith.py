"""The monolithic architecture: one loop that takes the newest frame and runs all detectors on it, one after another.

    python -m bench.cambada.monolith VENUE SECONDS PRIORITY FOLDER

A frame that arrives while the loop is busy is taken next, unless a newer one has arrived by then; in that case it is
skipped. PRIORITY 0 is an ordinary process, as the paper's loops were. The process saves the activation logs ``loop``
and ``loop's ball_om`` in FOLDER and prints the scheduling policy that was granted.
"""

import sys
import time
from pathlib import Path

import numpy as np

from bench.cambada.activation_log import ActivationLog
from bench.cambada.detectors import DETECTORS, Detector, detector_of
from bench.cambada.paper import RATE_HZ
from vision_core.clock import NS_PER_S, Instant, MonotonicClock, seconds_between
from vision_core.geometry import Bytes
from vision_core.native.opencv import read_picture
from vision_core.scheduling.realtime import ask_priority, exact_timers, freeze_garbage, lock_memory
from vision_core.venues.loader import load_settings

LOOP, BALL = "loop", "loop's ball_om"
PERIOD_NS = round(NS_PER_S / RATE_HZ)


def main() -> None:
    """Run for some seconds."""
    venue, seconds, priority, folder = sys.argv[1:]
    settings = load_settings(venue=venue)
    images = [read_picture(path) for path in sorted(Path(settings.source.uri.partition(":")[2]).iterdir())]
    detectors = {name: detector_of(name, settings) for name in DETECTORS}
    freeze_garbage()
    exact_timers()
    if int(priority):
        lock_memory()
    granted = ask_priority(int(priority))
    print(f"{granted.policy}, FIFO {priority} refused" if granted.refusal else granted.policy)
    for name, log in run(images, detectors, float(seconds)).items():
        log.save(Path(folder), name)


def run(images: list[Bytes], detectors: dict[str, Detector], seconds: float) -> dict[str, ActivationLog]:
    """Loop for some seconds [s] over images that arrive at the paper's rate, again and again. Returns both logs."""
    clock = MonotonicClock()
    logs = {LOOP: ActivationLog(), BALL: ActivationLog()}
    copy = np.empty_like(images[0])
    origin, number = clock.now(), -1
    while seconds_between(origin, clock.now()) < seconds:
        number = max(number + 1, (clock.now() - origin) // PERIOD_NS)
        due = Instant(origin + number * PERIOD_NS)
        while (now := clock.now()) < due:
            time.sleep(seconds_between(now, due))
        np.copyto(copy, images[number % len(images)])
        found_any = False
        for name, detector in detectors.items():
            began = clock.now()
            found = detector.detect(copy, due) is not None
            found_any |= found
            if name == "ball_om":
                logs[BALL].add(due, began, clock.now(), number, found=found)
        logs[LOOP].add(due, now, clock.now(), number, found=found_any)
    return logs


if __name__ == "__main__":
    main()
