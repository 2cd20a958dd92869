"""The on-board camera's pictures: their time, and the same first hits by NumPy.

A picture has 16 rays per pixel. The first hits are those of one ray per pixel, without color, so that both sides do
the same.
"""

import time
from collections.abc import Callable
from functools import partial

import numpy as np

from bench.onboard_numpy import first_hits
from bench.runner import Row
from vision_core.capture.synthetic.world import World
from vision_core.clock import MS_PER_S
from vision_core.onboard.camera import OnboardCamera
from vision_core.onboard.scene import Scene
from vision_core.types.objects import Team
from vision_core.venues.loader import load_settings

SIZES_PX = ((320, 240), (640, 480))
WORLDS = 5
SECONDS_BETWEEN = 1.5


def run() -> list[Row]:
    """Rows for both sizes of a picture."""
    settings = load_settings()
    rows: list[Row] = []
    for size in SIZES_PX:
        camera, world = OnboardCamera(settings, (Team.BLUE, 2), size_px=size), World(settings)
        scenes = []
        for _ in range(WORLDS):
            world.advance(SECONDS_BETWEEN)
            scenes.append(camera.scene(world.snapshot()))
        methods: list[Callable[[Scene], object]] = [camera.picture, camera.labels, partial(first_hits, camera)]
        picture_ms, labels_ms, numpy_ms = (_median_ms(method, scenes) for method in methods)
        same = np.mean([(camera.labels(scene)[0] == first_hits(camera, scene)[0]).mean() for scene in scenes])
        name = f"{size[0]}x{size[1]}"
        rows += [
            {"name": f"on-board picture of {name}", "value": picture_ms, "unit": "ms"},
            {
                "name": f"first hits of {name}, baseline NumPy",
                "value": labels_ms,
                "unit": "ms",
                "baseline": numpy_ms,
                "ratio": labels_ms / numpy_ms,
            },
            {
                "name": f"first hits of {name} that agree with NumPy",
                "value": float(same),
                "unit": "",
                "goal": ">= 0.9999",
                "met": bool(same >= 0.9999),
            },
        ]
    return rows


def _median_ms(method: Callable[[Scene], object], scenes: list[Scene]) -> float:
    """Median processor time for a scene, after a first one [ms]."""
    method(scenes[0])
    durations = []
    for scene in scenes:
        began = time.process_time()
        method(scene)
        durations.append(time.process_time() - began)
    return float(np.median(durations)) * MS_PER_S
