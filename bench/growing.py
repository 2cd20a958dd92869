"""Region growing from the last position against segmentation of the whole picture, on the same rendered frames.

Eleven trackers follow the ball and ten center dots by region growing, as the CAMBADA robots followed their objects. The
baseline segments the whole picture once (reference segmentation) and takes for each object the valid blob that is
nearest to the position predicted by its tracker. In 20 of 100 frames the ball is covered with carpet: it must then be
searched in the whole picture and not be found. Objects of its color and size beside the field are not valid, since no
carpet surrounds them; the baseline checks that on a circle around the blob.

Agreement: how often both find the same region to the pixel, or both find none; the goal is 99 %. Times [us]: execution
time of the thread, which other processes do not affect; a ratio below 1 means that region growing is faster. The
histogram of the ball's tracker is that of the CAMBADA paper's figure 3; it goes to ``bench/out/growing.png`` as well.
"""

import argparse
import math
import time
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from itertools import pairwise
from pathlib import Path

import numpy as np

from app.web.charts.panels import BLUE, Panel, Series, draw_panels
from bench.accuracy import settings_of
from bench.region_growing.region import (
    color_of_classes,
    color_of_seed,
)
from bench.region_growing.tracker import GrowingLimits, GrowingTracker
from bench.runner import OUT, Row
from bench.segmenters import ReferenceSegmenter
from vision_core.capture.source import open_source
from vision_core.capture.synthetic.camera import SyntheticCamera
from vision_core.capture.synthetic.truth import Truth
from vision_core.clock import Instant, MonotonicClock
from vision_core.color.lookup_table import compile_color_table, keep_classes
from vision_core.color.spaces import ycc_from_bgr
from vision_core.geometry import Bytes, Floats
from vision_core.models.camera_setup import CameraSetup
from vision_core.native.opencv import write_picture
from vision_core.settings.schema import Settings
from vision_core.types.colors import ColorTable
from vision_core.types.tables import Table

FRAMES = {"640x480": 600, "1280x1024": 200}
HISTOGRAM = "640x480"
COVERED = range(60, 80)
"""Of every hundred frames, those in which the ball is covered."""
BALL, SEED = "ball", "ball by a seed color"
DOT_RADIUS_M = 0.025
SEED_TOLERANCES = (70.0, 35.0)
"""Of luma and chroma [grey levels]."""
CARPET_TOLERANCES = (60.0, 20.0)
MIN_AROUND = 0.3
"""Least share of carpet around a ball; robots and lines may cover the rest."""
RING_RADII, RING_POINTS = 1.8, 24
"""Radius of the circle around a blob, in radii of the blob, and the points on it."""
MIN_AGREEMENT = 0.99
SEED_PX = 1.0
"""A seed's region may differ from the class's at its edge: largest distance of their centroids [px]."""
BINS = 20

Region = tuple[float, float, float] | None
"""Area [px] and centroid [px] of a region; None: not found."""


@dataclass
class Measured:
    """Counts and times at one size of the picture."""

    frames: int = 0
    same: dict[str, int] = field(default_factory=dict)
    seen: dict[str, int] = field(default_factory=dict)
    on_own_robot: int = 0
    """Trackers of center dots that are still on their robot at the end."""
    dots: int = 0
    growing_us: list[float] = field(default_factory=list)
    """All eleven trackers together."""
    ball_us: list[float] = field(default_factory=list)
    covered: list[bool] = field(default_factory=list)
    seed_us: list[float] = field(default_factory=list)
    table_us: list[float] = field(default_factory=list)


def run(out: Path = OUT) -> list[Row]:
    """Compare at every size. out: folder of the ball's histogram at one size."""
    rows: list[Row] = []
    for size, frames in FRAMES.items():
        measured = measure(settings_of(size, {}), frames)
        rows += [{"name": f"{size}: {row.pop('name')}"} | row for row in _summary(measured)]
        if size == HISTOGRAM:
            rows += _bins(measured)
            out.mkdir(parents=True, exist_ok=True)
            draw_histogram(out / "growing.png", measured, size)
    return rows


def measure(settings: Settings, frames: int) -> Measured:
    """Find all objects in a number of frames, by region growing and by segmentation."""
    table = keep_classes(compile_color_table(settings.colors), {"blue", "yellow", settings.ball.color})
    segmenter = ReferenceSegmenter(*CameraSetup.from_settings(settings).size_px, settings.blobs)
    trackers: dict[str, GrowingTracker] = {}
    measured = Measured()
    for pixels, at, truth, covered in _frames(settings, frames):
        if not trackers:
            carpet = _carpet(settings, pixels)
            trackers = _trackers(settings, table, truth, carpet)
            for tracker in trackers.values():
                tracker.follow(pixels, Instant(at - 1))
            segmenter.segment(pixels, table)
        predictions = {name: tracker.predict(at) for name, tracker in trackers.items()}
        found, spent = _grow(trackers, pixels, at, measured.frames)
        start = time.thread_time_ns()
        count, _ = segmenter.segment(pixels, table)
        measured.table_us.append((time.thread_time_ns() - start) / 1e3)
        _count(measured, _nearest_blobs(settings, table, pixels, carpet, segmenter.blobs[:count], predictions), found)
        measured.frames += 1
        measured.covered.append(covered)
        measured.ball_us.append(spent[BALL])
        measured.seed_us.append(spent[SEED])
        measured.growing_us.append(sum(us for name, us in spent.items() if name != SEED))
    _count_on_own_robot(measured, settings, truth, trackers)
    return measured


def _frames(settings: Settings, frames: int) -> Iterator[tuple[Bytes, Instant, Truth, bool]]:
    """Rendered frames with their truth; in some the ball is covered with the carpet beside it."""
    source = open_source(settings, CameraSetup.from_settings(settings), MonotonicClock(), paced=False)
    assert isinstance(source, SyntheticCamera)
    camera = CameraSetup.from_settings(settings).model
    pixels = CameraSetup.from_settings(settings).black_image()
    for number in range(frames):
        at = source.grab(pixels)
        ball = np.array([(source.truth.ball.x_m, source.truth.ball.y_m)])
        covered = number % 100 in COVERED
        if covered:
            (x, y), scale = camera.pixel_from_field(ball).astype(int)[0], camera.pixels_per_metre(ball[0])
            _cover(pixels, int(x), int(y), math.ceil(3.0 * settings.ball.radius_m * scale))
        yield pixels, at, source.truth, covered
    source.close()


def _cover(pixels: Bytes, x: int, y: int, reach: int) -> None:
    height, width, _ = pixels.shape
    top, bottom, left, right = max(y - reach, 0), min(y + reach, height), max(x - reach, 0), min(x + reach, width)
    pixels[top:bottom, left:right] = np.median(pixels[top:bottom, left:right].reshape(-1, 3), axis=0)


def _carpet(settings: Settings, pixels: Bytes) -> Table:
    """The carpet's color, from a grid of points on the field."""
    steps = np.linspace(-0.45, 0.45, 20)
    points = np.stack(np.meshgrid(steps * settings.field.length_m, steps * settings.field.width_m), axis=-1)
    x, y = CameraSetup.from_settings(settings).model.pixel_from_field(points.reshape(-1, 2)).round().astype(int).T
    blue, green, red = np.median(pixels[y, x], axis=0).tolist()
    return color_of_seed((blue, green, red), *CARPET_TOLERANCES)


def _trackers(settings: Settings, table: ColorTable, truth: Truth, carpet: Table) -> dict[str, GrowingTracker]:
    """A tracker for the ball by its class, one by a seed color, and one for each center dot, from its true place."""
    size = CameraSetup.from_settings(settings).size_px
    number = table.index(settings.ball.color)
    ball = replace(_limits(settings, BALL), around=carpet, min_around=MIN_AROUND)
    blue, green, red = table.mean_bgr[number].tolist()
    return {
        BALL: GrowingTracker(*size, color_of_classes(number), ball, table),
        SEED: GrowingTracker(*size, color_of_seed((blue, green, red), *SEED_TOLERANCES), ball),
    } | {
        f"{robot.team} {robot.id}": GrowingTracker(
            *size,
            color_of_classes(table.index(robot.team)),
            _limits(settings, "dots"),
            table,
            (float(place[0]), float(place[1])),
        )
        for robot, place in zip(truth.robots, _dots_px(settings, truth), strict=True)
    }


def _limits(settings: Settings, name: str) -> GrowingLimits:
    """Area limits of an object at the field's center."""
    is_ball = name in (BALL, SEED)
    radius, height = (settings.ball.radius_m,) * 2 if is_ball else (DOT_RADIUS_M, settings.robots.height_m)
    scale = CameraSetup.from_settings(settings).model.pixels_per_square_metre(np.zeros((1, 2)), height)[0]
    area = math.pi * radius**2 * scale
    return GrowingLimits(int(settings.robots.min_area * area), math.ceil(settings.robots.max_area * area))


def _dots_px(settings: Settings, truth: Truth) -> Floats:
    """True places of the robots' center dots, shape (n, 2) [px]."""
    places = np.array([(robot.x_m, robot.y_m) for robot in truth.robots])
    return CameraSetup.from_settings(settings).model.pixel_from_field(places, settings.robots.height_m)


def _grow(
    trackers: dict[str, GrowingTracker], pixels: Bytes, at: Instant, frame: int
) -> tuple[dict[str, Region], dict[str, float]]:
    """The region that each tracker found, and how long that took [us]. They take turns in being first."""
    found: dict[str, Region] = {}
    spent = {}
    turn = frame % len(trackers)
    for name, tracker in [*trackers.items()][turn:] + [*trackers.items()][:turn]:
        start = time.thread_time_ns()
        blob = tracker.follow(pixels, at)
        spent[name] = (time.thread_time_ns() - start) / 1e3
        found[name] = None if blob is None else blob[["area_px", "x_px", "y_px"]][0].item()
    return found, spent


def _nearest_blobs(
    settings: Settings,
    table: ColorTable,
    pixels: Bytes,
    carpet: Table,
    blobs: Table,
    predictions: dict[str, tuple[float, float]],
) -> dict[str, Region]:
    """For each object the valid blob that is nearest to its predicted position."""
    segmented: dict[str, Region] = {}
    for name, place in predictions.items():
        is_ball, limits = name in (BALL, SEED), _limits(settings, name)
        color = settings.ball.color if is_ball else name.split()[0]
        valid = np.flatnonzero(
            (blobs["color"] == table.index(color))
            & (blobs["area_px"] >= limits.min_area_px)
            & (blobs["area_px"] <= limits.max_area_px)
        )
        if is_ball:
            valid = valid[[_carpet_share(pixels, carpet, blobs[blob]) >= MIN_AROUND for blob in valid.tolist()]]
        distances = np.hypot(blobs["x_px"][valid] - place[0], blobs["y_px"][valid] - place[1])
        best = valid[distances.argmin()] if len(valid) else None
        segmented[name] = None if best is None else blobs[["area_px", "x_px", "y_px"]][best].item()
    return segmented


def _carpet_share(pixels: Bytes, carpet: Table, blob: Table) -> float:
    """Share of the points on a circle around a blob that show carpet, 0..1."""
    radius = RING_RADII * math.sqrt(blob["area_px"] / math.pi)
    turn = np.arange(RING_POINTS) * (math.tau / RING_POINTS)
    ring = (blob["x_px"], blob["y_px"]) + radius * np.column_stack([np.cos(turn), np.sin(turn)])
    height, width, _ = pixels.shape
    x, y = np.clip(ring.round().astype(int), 0, (width - 1, height - 1)).T
    luma, cb, cr = ycc_from_bgr(pixels[y, x]).T
    near = np.hypot(cb - carpet["cb"], cr - carpet["cr"]) <= carpet["chroma_tolerance"]
    return float((near & (abs(luma - carpet["luma"]) <= carpet["luma_tolerance"])).mean())


def _count(measured: Measured, segmented: dict[str, Region], found: dict[str, Region]) -> None:
    for name, grown in found.items():
        kind = name if name in (BALL, SEED) else "center dots"
        same = _agree(grown, segmented[name], by_pixel=name != SEED)
        measured.same[kind] = measured.same.get(kind, 0) + same
        measured.seen[kind] = measured.seen.get(kind, 0) + 1


def _agree(one: Region, other: Region, *, by_pixel: bool) -> bool:
    if one is None or other is None:
        return one is other
    return np.allclose(one, other) if by_pixel else math.dist(one[1:], other[1:]) < SEED_PX


def _count_on_own_robot(
    measured: Measured, settings: Settings, truth: Truth, trackers: dict[str, GrowingTracker]
) -> None:
    for robot, place in zip(truth.robots, _dots_px(settings, truth), strict=True):
        tracker = trackers[f"{robot.team} {robot.id}"]
        scale = CameraSetup.from_settings(settings).model.pixels_per_metre(
            (robot.x_m, robot.y_m), settings.robots.height_m
        )
        measured.on_own_robot += math.dist(tracker.last_px, place) < DOT_RADIUS_M * scale
        measured.dots += 1


def _summary(measured: Measured) -> Iterator[Row]:
    for kind, same in measured.same.items():
        share = same / measured.seen[kind]
        yield {
            "name": f"{kind}: same region as by segmentation, of {measured.seen[kind]}", "value": same, "unit": "",
            "ratio": share, "goal": f">= {MIN_AGREEMENT:g}", "met": share >= MIN_AGREEMENT,
        }  # fmt: skip
    yield {"name": f"center dots still on their robot at the end, of {measured.dots}", "value": measured.on_own_robot}
    whole_us = float(np.median(measured.table_us))
    covered = np.array(measured.covered)
    ball, seed = np.array(measured.ball_us), np.array(measured.seed_us)
    for name, times in (
        ("ball and ten dots", np.array(measured.growing_us)),
        ("ball, not covered", ball[~covered]),
        ("ball, covered: the whole picture is searched", ball[covered]),
        ("ball by a seed color, not covered", seed[~covered]),
        ("ball by a seed color, covered", seed[covered]),
    ):
        if len(times):
            median = float(np.median(times))
            yield {"name": name, "value": median, "unit": "us", "baseline": whole_us, "ratio": median / whole_us}


def _bins(measured: Measured) -> Iterator[Row]:
    edges, counts = histogram(measured)
    for (low, high), count in zip(pairwise(edges), counts, strict=True):
        times = f"{low:.0f} .. {high:.0f} us" if high < math.inf else f"{low:.0f} us and more"
        yield {"name": f"{HISTOGRAM}: ball in {times}", "value": count, "unit": "frames"}


def histogram(measured: Measured) -> tuple[list[float], list[int]]:
    """Edges [us] and counts of the ball's times; the last bin holds all that took longer."""
    times = np.array(measured.ball_us)
    width = max(1.0, math.ceil(float(np.percentile(times, 99.0)) / (BINS - 1)))
    bins = np.minimum(times // width, BINS - 1).astype(int)
    return [width * index for index in range(BINS)] + [math.inf], np.bincount(bins, minlength=BINS).tolist()


def draw_histogram(path: Path, measured: Measured, size: str) -> None:
    """Draw the histogram as in the CAMBADA paper's figure 3."""
    edges, counts = histogram(measured)
    panel = Panel(
        title=f"{measured.frames} frames, the ball covered in {sum(measured.covered)}",
        axis="time of the ball's tracker [us]; the last bin holds all that took longer",
        edges=tuple(edges),
        series=(Series("ball", tuple(counts), BLUE),),
        numbered=True,
        counted="frames",
    )
    write_picture(path, draw_panels([panel], f"region growing, {size}", 1, (860, 420)))


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, default=OUT, help="folder for the histogram")
    for row in run(parser.parse_args().out):
        print(row)
