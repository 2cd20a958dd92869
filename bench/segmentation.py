"""Pixels to blobs: rows and flood fill against the classic, the same in C, and a memcpy of the frame.

Distinct frames of the synthetic camera, ten robots, the default look. The ways take turns, frame by frame, in one
process; in each turn every way has another frame, which the others have not touched for a while, so that all of them
find it equally far away in memory. Medians. Recall: of the classic's blobs in the windows round robots and ball that
are as high as the smallest dot asks for, those found equal in class, area, center and box.
"""

import ctypes
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bench.baselines.build import load_library
from bench.runner import Row
from vision_core.blobs.rows import FastSegmenter, least_height_px
from vision_core.blobs.run_lengths import Segmenter
from vision_core.capture.source import open_source
from vision_core.capture.synthetic.camera import SyntheticCamera
from vision_core.capture.synthetic.truth import Truth
from vision_core.clock import MonotonicClock
from vision_core.color.lookup_table import compile_color_table
from vision_core.color.prefilter import candidate_test
from vision_core.geometry import Bytes
from vision_core.models.camera import CameraModel
from vision_core.models.camera_setup import CameraSetup
from vision_core.settings.schema import Settings
from vision_core.types.colors import ColorTable
from vision_core.types.prefilter import Candidates
from vision_core.types.tables import BLOB, Table
from vision_core.venues.loader import load_settings

FRAMES = 24
ROUNDS = 8
WARM_ROUNDS = 2
DOT_M = 0.04
"""The smallest patch of the pattern, across."""
WINDOW_M = 0.2
"""Half a window round a predicted robot; a ball's is as large."""
SIZES: dict[str, dict[str, Any]] = {
    f"{width}x{height}": {
        "camera.width_px": width,
        "camera.height_px": height,
        "camera.pinhole.focal_px": focal,
        "camera.pinhole.center_px": center,
    }
    for width, height, focal, center in (
        (640, 480, 700.0, [318.2, 241.1]),
        (1280, 1024, 1420.0, [637.1, 514.6]),
        (2048, 1536, 2240.0, [1020.0, 771.0]),
    )
}
GOALS = {"640x480": 0.35, "1280x1024": 0.20, "2048x1536": 0.12}
CLASSIC, TWIN, MEMCPY = "classic", "classic in C", "memcpy"
WHOLE, WINDOWS = "rows + flood, whole frame", "rows + flood, windows + strip"
US_PER_S = 1e6

Boxes = NDArray[np.int32]
Way = Callable[[int], int]
"""Segments a frame by its number; how many blobs there are, in ``Ways.blobs``."""


@dataclass(frozen=True, slots=True)
class Scene:
    """What all ways are given."""

    settings: Settings
    table: ColorTable
    candidates: Candidates
    frames: list[Bytes]
    windows: list[Boxes]
    least_px: int


def run() -> list[Row]:
    """Rows for every size."""
    rows: list[Row] = []
    for size, options in SIZES.items():
        rows += _measure(size, _scene(load_settings(options=options)))
    return rows


def _scene(settings: Settings) -> Scene:
    camera = CameraSetup.from_settings(settings).model
    source = open_source(settings, CameraSetup.from_settings(settings), MonotonicClock(), paced=False)
    assert isinstance(source, SyntheticCamera)
    frames, windows = [], []
    for _ in range(FRAMES):
        pixels = CameraSetup.from_settings(settings).black_image()
        source.grab(pixels)
        frames.append(pixels)
        windows.append(_windows(source.truth, camera, settings))
    source.close()
    corner = np.array([settings.field.length_m, settings.field.width_m]) / 2
    dot_px = DOT_M * camera.pixels_per_metre(corner.tolist(), settings.robots.height_m)
    table = compile_color_table(settings.colors)
    least = least_height_px(dot_px, settings.blobs.row_step)
    return Scene(settings, table, candidate_test(table), frames, windows, least)


def _windows(truth: Truth, camera: CameraModel, settings: Settings) -> Boxes:
    """Boxes round the robots and the ball, as a tracker would predict them."""
    robots = camera.pixel_from_field(np.array([(r.x_m, r.y_m) for r in truth.robots]), settings.robots.height_m)
    ball = camera.pixel_from_field(np.array([(truth.ball.x_m, truth.ball.y_m)]))
    centers = np.vstack([robots, ball])
    half = WINDOW_M * camera.pixels_per_metre([0.0, 0.0], settings.robots.height_m)
    return np.hstack([centers - half, centers + half]).round().astype(np.int32)


class Ways:
    """Every way to segment a scene, each with memory of its own."""

    def __init__(self, scene: Scene) -> None:
        settings, frames = scene.settings, scene.frames
        size = settings.camera.width_px, settings.camera.height_px
        classic = Segmenter(*size, settings.blobs)
        whole, windows = (FastSegmenter(*size, settings.blobs, scene.least_px) for _ in range(2))
        copy = np.empty_like(frames[0])
        table, test = scene.table, scene.candidates
        self.blobs: dict[str, Table] = {CLASSIC: classic.blobs, WHOLE: whole.blobs, WINDOWS: windows.blobs}
        self.calls: dict[str, Way] = {
            CLASSIC: lambda number: classic.segment(frames[number], table)[0],
            WHOLE: lambda number: whole.segment(frames[number], table, test)[0],
            WINDOWS: lambda number: windows.segment(frames[number], table, test, scene.windows[number])[0],
        }
        twin, self.word = twin_of(scene)
        if twin is not None:
            self.calls[TWIN], self.blobs[TWIN] = twin
        self.calls[MEMCPY] = lambda number: _copy(copy, frames[number])


def _copy(copy: Bytes, pixels: Bytes) -> int:
    copy[:] = pixels
    return 0


def twin_of(scene: Scene) -> tuple[tuple[Way, Table] | None, str]:
    """The classic in C and the table that it fills, or None and why there is none."""
    library, word = load_library("segmentation")
    if library is None:
        return None, word
    camera, chosen = scene.settings.camera, scene.settings.blobs
    runs = np.zeros(chosen.max_runs * 24, dtype=np.uint8)
    regions = np.zeros(chosen.max_runs * 48, dtype=np.uint8)
    blobs = np.zeros(chosen.max_blobs, dtype=BLOB)
    classes = scene.table.classes
    pointers = [ctypes.c_void_p(array.ctypes.data) for array in (classes, runs, regions, blobs)]
    images = [ctypes.c_void_p(frame.ctypes.data) for frame in scene.frames]

    def segment(number: int) -> int:
        found = library.segment(
            images[number], camera.width_px, camera.height_px, pointers[0], chosen.min_area_px,
            pointers[1], pointers[2], chosen.max_runs, pointers[3], chosen.max_blobs,
        )  # fmt: skip
        assert found >= 0, f"no room in {len(runs)} and {len(regions)} bytes"
        return int(found)

    return (segment, blobs), word


def _measure(size: str, scene: Scene) -> list[Row]:
    ways = Ways(scene)
    recall = {name: _recall(scene, ways, name) for name in ways.blobs}
    times: dict[str, list[float]] = {name: [] for name in ways.calls}
    apart = FRAMES // len(ways.calls)
    for turn in range((WARM_ROUNDS + ROUNDS) * FRAMES):
        for place, (name, call) in enumerate(ways.calls.items()):
            number = (turn + apart * place) % FRAMES
            began = time.perf_counter()
            call(number)
            times[name].append(time.perf_counter() - began)
    took = {name: float(np.median(seconds[WARM_ROUNDS * FRAMES :])) for name, seconds in times.items()}
    rows = [_row(f"{size}: {name}", took[name] * US_PER_S, "us") for name in took]
    if TWIN not in took:
        rows.append(_row(f"{size}: {TWIN}: {ways.word}", None, ""))
    for name, goal in ((WHOLE, GOALS[size]), (WINDOWS, None)):
        rows.append(_ratio(f"{size}: {name}, of the classic", took[name], took[CLASSIC], goal))
    rows.append(_ratio(f"{size}: {WHOLE}, of a memcpy (moonshot)", took[WHOLE], took[MEMCPY], 1.0))
    if TWIN in took:
        rows.append(_ratio(f"{size}: {WHOLE}, of the classic in C", took[WHOLE], took[TWIN], None))
        rows.append(_ratio(f"{size}: classic, of the classic in C", took[CLASSIC], took[TWIN], None))
    for name, share in recall.items():
        if name != CLASSIC:
            rows.append({**_row(f"{size}: recall, {name}", share, ""), "goal": "1.0", "met": share == 1.0})
    return rows


def _recall(scene: Scene, ways: Ways, name: str) -> float:
    """Share of the classic's marker blobs that a way has, to the bit."""
    asked = found = 0
    for number, windows in enumerate(scene.windows):
        expected = ways.blobs[CLASSIC][: ways.calls[CLASSIC](number)].copy()
        have = set(ways.blobs[name][: ways.calls[name](number)].tolist())
        tall = expected[expected["bottom"] - expected["top"] + 1 >= scene.least_px]
        for blob in tall:
            x, y = blob["x_px"], blob["y_px"]
            inside = (windows[:, 0] <= x) & (x <= windows[:, 2]) & (windows[:, 1] <= y) & (y <= windows[:, 3])
            asked += bool(inside.any())
            found += bool(inside.any()) and blob.item() in have
    return found / asked


def _row(name: str, value: float | None, unit: str) -> Row:
    return {"name": name, "value": value, "unit": unit, "baseline": None, "ratio": None, "goal": None, "met": None}


def _ratio(name: str, took: float, other: float, goal: float | None) -> Row:
    ratio = took / other
    return {
        **_row(name, took * US_PER_S, "us"),
        "baseline": other * US_PER_S,
        "ratio": ratio,
        "goal": None if goal is None else f"<= {goal:.2f}x",
        "met": None if goal is None else ratio <= goal,
    }
