"""Frames and views are joined by their Time; a stage's share is told from the database's stamps."""

import json
import subprocess

import pytest

from bench.baselines.build import build_program
from bench.frame_path import WAY
from bench.handover import busy_by_task, joined

BOOT = 1_000_000_000
PERIOD = 5_000_000


def measured(number: int) -> int:
    return BOOT + number * PERIOD + 321


def test_views_meet_their_frames() -> None:
    stamps = [(measured(number), measured(number) + 50_000) for number in range(5)]
    times = [(at - BOOT) // 1000 for at, _ in stamps]
    views = [[times[k], count, 0, stamps[k][1] + 700_000] for k, count in ((0, 22), (1, 21), (3, 22))]
    told = joined(stamps, {"clients": 22, "views": views}, BOOT, {}, [])
    assert told.delivered_us.tolist() == [700.0, 700.0]
    assert (told.frames, told.incomplete, told.unserved) == (4, 1, 1)  # the fifth is under way


def test_a_stage_is_busy_from_its_beginning_to_its_result() -> None:
    frames = [(number, number + 1000) for number in range(0, 50_000, 1000)]
    sightings = [(number, at + 400_000) for number, at in frames]
    views = [(number, at + 900_000) for number, at in frames if number % 3000]
    busy = busy_by_task(dict(zip(WAY, (frames, sightings, views), strict=True)), {"perceive": 50.0, "serve": 60.0})
    assert busy == {"perceive": 350.0, "serve": 440.0}


def test_the_twin_hands_every_frame_on() -> None:
    program, word = build_program("handover")
    if program is None:
        pytest.skip(word)
    said = subprocess.run([program, "100", "20", "100", "100"], capture_output=True, check=True, text=True)
    report = json.loads(said.stdout)
    served = len(report["delivered_us"])
    assert served + report["skipped"] + report["incomplete"] == report["published"] == 20
    assert len(report["sending_us"]) == served
    assert all(0.0 < took < whole for took, whole in zip(report["sending_us"], report["read_us"], strict=True))
