"""Frames and views are joined by Time; the work of each task follows from the timestamps of its records."""

import json
import subprocess

import pytest

from bench.baselines.build import build_program
from bench.frame_path import FRAME_PATH
from bench.handover import joined_latencies, served, work_by_task

BOOT = 1_000_000_000
PERIOD = 5_000_000


def measured(number: int) -> int:
    return BOOT + number * PERIOD + 321


def test_views_are_joined_with_their_frames() -> None:
    timestamps = [(measured(number), measured(number) + 50_000) for number in range(5)]
    times = [(at - BOOT) // 1000 for at, _ in timestamps]
    views = [[times[k], count, 0, timestamps[k][1] + 700_000] for k, count in ((0, 22), (1, 21), (3, 22))]
    received = {"clients": 22, "views": views}
    assert [latency for _, latency in joined_latencies(timestamps, received, BOOT)] == [700_000, 700_000]
    found = served(timestamps, received, BOOT)  # the fifth was still on its way
    assert found == "4 frames, of which 1 reached not all clients and 1 none"


def test_the_work_of_a_task_lasts_from_the_start_of_its_run_to_its_result() -> None:
    frames = [(number, number + 1000) for number in range(0, 50_000, 1000)]
    sightings = [(number, at + 400_000) for number, at in frames]
    views = [(number, at + 900_000) for number, at in frames if number % 3000]
    work_us = work_by_task(
        dict(zip(FRAME_PATH, (frames, sightings, views), strict=True)), {"perceive": 50.0, "serve": 60.0}
    )
    assert work_us == {"perceive": 350.0, "serve": 440.0}


def test_the_baseline_accounts_for_every_frame() -> None:
    program, message = build_program("handover")
    if program is None:
        pytest.skip(message)
    done = subprocess.run([program, "100", "20", "100", "100"], capture_output=True, check=True, text=True)
    report = json.loads(done.stdout)
    served = len(report["delivered_us"])
    assert served + report["skipped"] + report["incomplete"] == report["published"] == 20
    assert len(report["sending_us"]) == served
    assert all(0.0 < took < whole for took, whole in zip(report["sending_us"], report["read_us"], strict=True))
