"""Duration of segmenting one picture into blobs, at three sizes.

Distinct frames of the simulated camera with ten robots. Measured [us]: median duration of the service's row scan, over
the whole picture, and over windows with the scan band; the windows are those that the service's own perception places
in these frames where no robot is known. Baselines in the same process: the reference segmentation, which reads every
pixel; the same in C (``baselines/segmentation.c``); and a memcpy of the picture, which is the least that reading it
costs. The methods take turns, frame by frame, each on a frame that no other has touched for a while, so that the caches
favor none.

Recall: of the reference's blobs on robots and ball that are at least as high as the smallest dot of a marker, the share
that is found with equal class, area, center and box. 1.0 is the goal.
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
from bench.segmenters import ReferenceSegmenter, RowScanSegmenter
from vision_core.blobs.row_scan import LEFT, RIGHT
from vision_core.capture.source import open_source
from vision_core.capture.synthetic.camera import SyntheticCamera
from vision_core.capture.synthetic.truth import Truth
from vision_core.clock import US_PER_S, MonotonicClock
from vision_core.color.lookup_table import compile_color_table
from vision_core.color.prefilter import prefilter_from
from vision_core.geometry import Bytes
from vision_core.models.camera import CameraModel
from vision_core.models.camera_setup import CameraSetup
from vision_core.pipeline.perception import Perception
from vision_core.settings.schema import Settings
from vision_core.types.colors import ColorTable
from vision_core.types.image import ImageFrame
from vision_core.types.prefilter import ColorPrefilter
from vision_core.types.tables import BLOB, Table
from vision_core.venues.loader import load_settings

FRAMES = 24
ROUNDS = 8
WARM_ROUNDS = 2
SETTLE_FRAMES = 30
"""Perceived before the first frame that is measured: windows depend on what the frames before it show."""
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
REFERENCE, IN_C, MEMCPY = "reference", "reference in C", "memcpy"
WHOLE, WINDOWS = "row scan, whole picture", "row scan, windows and scan band"

Boxes = NDArray[np.int32]
Method = Callable[[int], int]
"""Segments the frame with a number into ``Methods.blobs`` and returns how many blobs there are."""


@dataclass(frozen=True, slots=True)
class Scene:
    """The input of all methods."""

    settings: Settings
    table: ColorTable
    prefilter: ColorPrefilter
    frames: list[Bytes]
    windows: list[Boxes]
    """Of each frame, as perception places them."""
    objects: list[Boxes]
    """Boxes around the robots and the ball of each frame, in which recall is counted."""
    min_px: int
    """Height of the lowest blob that must be found, as perception has it."""


def run() -> list[Row]:
    """Measure every size."""
    rows: list[Row] = []
    for size, options in SIZES.items():
        rows += _measure(size, scene_of(load_settings(options=options)))
    return rows


def scene_of(settings: Settings) -> Scene:
    """Frames, and the windows of a perception that follows them. Raises RuntimeError when it searches a frame whole."""
    camera, clock = CameraSetup.from_settings(settings), MonotonicClock()
    source = open_source(settings, camera, clock, paced=False)
    assert isinstance(source, SyntheticCamera)
    perception = Perception(settings, camera)
    frames, windows, objects = [], [], []
    for number in range(1, SETTLE_FRAMES + FRAMES + 1):
        pixels = camera.black_image()
        grabbed = source.grab(pixels)
        placed = perception.context.windows
        placed.fill(0)
        perception.context.held.size[0] = 0  # no robot is known, so each has a window
        perception.perceive(ImageFrame(camera.name, number, grabbed, pixels), clock)
        if number > SETTLE_FRAMES:
            frames.append(pixels)
            windows.append(placed[placed[:, RIGHT] > placed[:, LEFT]])
            objects.append(_objects(source.truth, camera.model, settings))
    source.close()
    if not all(map(len, windows)):
        raise RuntimeError("segmentation: a frame was searched whole; windows around robots and ball were expected")
    table = compile_color_table(settings.colors)
    min_px = perception.context.segment.rows_apart
    return Scene(settings, table, prefilter_from(table), frames, windows, objects, min_px)


def _objects(truth: Truth, camera: CameraModel, settings: Settings) -> Boxes:
    """Boxes around the robots and the ball."""
    robots = camera.pixel_from_field(np.array([(r.x_m, r.y_m) for r in truth.robots]), settings.robots.height_m)
    ball = camera.pixel_from_field(np.array([(truth.ball.x_m, truth.ball.y_m)]))
    centers = np.vstack([robots, ball])
    half = settings.robots.radius_m * camera.pixels_per_metre([0.0, 0.0], settings.robots.height_m)
    return np.hstack([centers - half, centers + half]).round().astype(np.int32)


class Methods:
    """All methods of segmenting a scene, each with memory of its own."""

    def __init__(self, scene: Scene) -> None:
        settings, frames = scene.settings, scene.frames
        size = CameraSetup.from_settings(settings).size_px
        reference = ReferenceSegmenter(*size, settings.blobs)
        whole, windows = (RowScanSegmenter(*size, settings.blobs, scene.min_px) for _ in range(2))
        copy = np.empty_like(frames[0])
        table, prefilter = scene.table, scene.prefilter
        self.blobs: dict[str, Table] = {REFERENCE: reference.blobs, WHOLE: whole.blobs, WINDOWS: windows.blobs}
        self.calls: dict[str, Method] = {
            REFERENCE: lambda number: reference.segment(frames[number], table)[0],
            WHOLE: lambda number: whole.segment(frames[number], table, prefilter)[0],
            WINDOWS: lambda number: windows.segment(frames[number], table, prefilter, scene.windows[number])[0],
        }
        c_reference, self.message = c_reference_of(settings, table, frames)
        if c_reference is not None:
            self.calls[IN_C], self.blobs[IN_C] = c_reference
        self.calls[MEMCPY] = lambda number: _copy(copy, frames[number])


def _copy(copy: Bytes, pixels: Bytes) -> int:
    copy[:] = pixels
    return 0


def c_reference_of(
    settings: Settings, table: ColorTable, frames: list[Bytes]
) -> tuple[tuple[Method, Table] | None, str]:
    """The reference in C and the table that it fills, and the compiler's command; or None and the reason."""
    library, message = load_library("segmentation")
    if library is None:
        return None, message
    (height, width, _), chosen = frames[0].shape, settings.blobs
    row = np.zeros(width, dtype=np.uint8)
    runs = np.zeros(chosen.max_runs * 24, dtype=np.uint8)
    regions = np.zeros(chosen.max_runs * 48, dtype=np.uint8)
    blobs = np.zeros(chosen.max_blobs, dtype=BLOB)
    # such a pointer keeps its array alive, which nothing else does for row, runs and regions
    pointers = [array.ctypes.data_as(ctypes.c_void_p) for array in (table.classes, row, runs, regions, blobs)]
    images = [frame.ctypes.data_as(ctypes.c_void_p) for frame in frames]

    def segment(number: int) -> int:
        found = library.segment(
            images[number], width, height, pointers[0], chosen.min_area_px,
            *pointers[1:4], chosen.max_runs, pointers[4], chosen.max_blobs,
        )  # fmt: skip
        assert found >= 0, f"the C reference: {chosen.max_runs} runs and {chosen.max_blobs} blobs were not enough"
        return int(found)

    return (segment, blobs), message


def _measure(size: str, scene: Scene) -> list[Row]:
    methods = Methods(scene)
    recall = {name: recall_of(scene, methods, name) for name in methods.blobs}
    times: dict[str, list[float]] = {name: [] for name in methods.calls}
    apart = FRAMES // len(methods.calls)
    for turn in range((WARM_ROUNDS + ROUNDS) * FRAMES):
        for place, (name, call) in enumerate(methods.calls.items()):
            number = (turn + apart * place) % FRAMES
            began = time.perf_counter()
            call(number)
            times[name].append(time.perf_counter() - began)
    took = {name: float(np.median(seconds[WARM_ROUNDS * FRAMES :])) for name, seconds in times.items()}
    rows = [_row(f"{size}: {name}", took[name] * US_PER_S, "us") for name in took]
    if IN_C not in took:
        rows.append(_row(f"{size}: {IN_C}: {methods.message}", None, ""))
    for name, goal in ((WHOLE, GOALS[size]), (WINDOWS, None)):
        rows.append(_ratio(f"{size}: {name}, of the reference", took[name], took[REFERENCE], goal))
    rows.append(_ratio(f"{size}: {WHOLE}, of a memcpy", took[WHOLE], took[MEMCPY], 1.0))
    if IN_C in took:
        rows.append(_ratio(f"{size}: {WHOLE}, of the reference in C", took[WHOLE], took[IN_C], None))
        rows.append(_ratio(f"{size}: reference, of the reference in C", took[REFERENCE], took[IN_C], None))
    for name, share in recall.items():
        if name != REFERENCE:
            rows.append({**_row(f"{size}: recall, {name}", share, ""), "goal": "1.0", "met": share == 1.0})
    return rows


def recall_of(scene: Scene, methods: Methods, name: str) -> float:
    """Share of the reference's marker blobs that a method finds, equal in every field."""
    expected = found = 0
    for number, boxes in enumerate(scene.objects):
        of_reference = methods.blobs[REFERENCE][: methods.calls[REFERENCE](number)].copy()
        blobs = set(methods.blobs[name][: methods.calls[name](number)].tolist())
        tall = of_reference[of_reference["bottom"] - of_reference["top"] + 1 >= scene.min_px]
        for blob in tall:
            x, y = blob["x_px"], blob["y_px"]
            inside = (boxes[:, 0] <= x) & (x <= boxes[:, 2]) & (boxes[:, 1] <= y) & (y <= boxes[:, 3])
            expected += bool(inside.any())
            found += bool(inside.any()) and blob.item() in blobs
    return found / expected


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
