"""Centers finer than a pixel, on drawn discs with neighbors and on rendered markers, compared with the centroid."""

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.lib.recfunctions import structured_to_unstructured

from bench.segmenters import ReferenceSegmenter
from tests.objects.drawing import PAINTS
from vision_core.capture.source import open_source
from vision_core.capture.synthetic.camera import SyntheticCamera
from vision_core.clock import ManualClock
from vision_core.color.lookup_table import compile_color_table
from vision_core.geometry import Bytes, Floats
from vision_core.models.camera_setup import CameraSetup
from vision_core.native.kernels import read_only
from vision_core.objects.circle_fit import UNREFINED_SD, circle_buffer, refined_circle
from vision_core.patterns.loader import load_pattern
from vision_core.settings.schema import Settings
from vision_core.venues.loader import load_settings

SIZE = 41
FINE = 8
MIDDLE = 20.0
OFFSETS = st.tuples(st.floats(-0.5, 0.5), st.floats(-0.5, 0.5))
Disc = tuple[str, float, float, float]
"""Paint, center x, y and radius [px]."""


def picture(discs: list[Disc], ground: str = "body", noise: float = 2.0, seed: int = 3) -> Bytes:
    """Discs on a ground, one over the other, seen by a lens as sharp as its pixels."""
    steps = (np.arange(SIZE * FINE) + 0.5) / FINE - 0.5
    x, y = np.meshgrid(steps, steps)
    fine = np.full((*x.shape, 3), PAINTS[ground], dtype=np.float64)
    for paint, at_x, at_y, radius in discs:
        fine[np.hypot(x - at_x, y - at_y) <= radius] = PAINTS[paint]
    coarse = fine.reshape(SIZE, FINE, SIZE, FINE, 3).mean(axis=(1, 3))
    noisy = coarse + np.random.default_rng(seed).normal(0.0, noise, coarse.shape)
    return read_only(np.clip(np.rint(noisy), 0, 255).astype(np.uint8))


def error_of(pixels: Bytes, truth: tuple[float, float], radius: float, start: tuple[float, float]) -> float:
    x, y, _ = refined_circle(pixels, MIDDLE + start[0], MIDDLE + start[1], radius, circle_buffer())
    return math.dist((x, y), truth)


@settings(deadline=None, max_examples=40)
@given(OFFSETS, st.floats(3.5, 9.0), st.tuples(st.floats(-0.15, 0.15), st.floats(-0.15, 0.15)))
def test_a_disc_is_found_wherever_it_lies(offset: tuple[float, float], radius: float, off: tuple[float, float]) -> None:
    truth = MIDDLE + offset[0], MIDDLE + offset[1]
    pixels = picture([("pink", *truth, radius)])
    assert error_of(pixels, truth, radius, (offset[0] + off[0], offset[1] + off[1])) < 0.08


@settings(deadline=None, max_examples=40)
@given(OFFSETS, st.floats(0.0, math.tau), st.sampled_from(["pink", "green", "blue", "yellow"]))
def test_a_neighbor_a_pixel_away_pulls_nothing(offset: tuple[float, float], turn: float, paint: str) -> None:
    truth, radius, gap = (MIDDLE + offset[0], MIDDLE + offset[1]), 3.75, 0.95
    away = 2.0 * radius + gap
    neighbor = truth[0] + away * math.cos(turn), truth[1] + away * math.sin(turn)
    pixels = picture([("pink", *truth, radius), (paint, *neighbor, radius)])
    assert error_of(pixels, truth, radius, offset) < 0.12


@settings(deadline=None, max_examples=40)
@given(OFFSETS, st.floats(0.0, math.tau), st.floats(0.96, 1.04))
def test_what_covers_a_piece_of_the_rim_pulls_little_and_is_told(
    offset: tuple[float, float], turn: float, predicted: float
) -> None:
    truth, radius = (MIDDLE + offset[0], MIDDLE + offset[1]), 7.5
    cover = truth[0] + 12.5 * math.cos(turn), truth[1] + 12.5 * math.sin(turn)
    pixels = picture([("pink", *truth, radius), ("yellow", *cover, 7.0)])
    start = truth[0] - 0.3 * math.cos(turn), truth[1] - 0.3 * math.sin(turn)
    x, y, sd = refined_circle(pixels, *start, radius * predicted, circle_buffer())
    assert math.dist((x, y), truth) < max(0.15, 4.0 * sd)


@pytest.mark.parametrize(
    ("x", "y", "radius"),
    [(20.0, 20.0, 7.0), (0.0, 0.0, 5.0), (20.0, 20.0, 0.0), (math.nan, 3.0, 4.0), (90.0, 1.0, 4.0)],
)
def test_where_there_is_no_circle_the_center_stays_and_is_not_trusted(x: float, y: float, radius: float) -> None:
    found_x, found_y, sd = refined_circle(picture([]), x, y, radius, circle_buffer())
    np.testing.assert_equal((found_x, found_y), (x, y))
    assert sd >= UNREFINED_SD * max(radius, 1.0)


def test_half_a_disc_at_the_edge_of_the_picture_is_no_error() -> None:
    pixels = picture([("pink", 0.5, 20.0, 6.0)])
    x, y, sd = refined_circle(pixels, 2.0, 20.0, 6.0, circle_buffer())
    assert all(math.isfinite(value) for value in (x, y, sd))


def test_it_is_compiled_once_for_frames_and_drawings() -> None:
    kernel: Any = refined_circle
    refined_circle(picture([]), 20.0, 20.0, 4.0, circle_buffer())
    compiled = len(kernel.signatures)
    refined_circle(read_only(np.zeros((60, 80, 3), dtype=np.uint8)), 20.0, 20.0, 7.5, circle_buffer())
    assert len(kernel.signatures) == compiled


def markers(options: Settings, frames: int) -> tuple[Floats, Floats, Floats]:
    """Errors of refined centers and of centroids, shape (n, 2), and deviations, shape (n,), of rendered dots [px]."""
    source = open_source(options, CameraSetup.from_settings(options), ManualClock(), paced=False)
    assert isinstance(source, SyntheticCamera)
    camera, table = CameraSetup.from_settings(options).model, compile_color_table(options.colors)
    pattern = load_pattern(options.robots.patterns[0])
    slots = np.array([patch.circle_mm for patch in pattern.patches]) / 1000.0
    pixels = np.empty((options.camera.height_px, options.camera.width_px, 3), dtype=np.uint8)
    segmenter, memory = ReferenceSegmenter(pixels.shape[1], pixels.shape[0], options.blobs), circle_buffer()
    refined, plain, sds = [], [], []
    for _ in range(frames):
        source.grab(pixels)
        seen = read_only(pixels)
        count, _ = segmenter.segment(seen, table)
        centers = structured_to_unstructured(segmenter.blobs[["x_px", "y_px"]][:count])
        for robot in source.truth.robots:
            c, s = math.cos(robot.heading_rad), math.sin(robot.heading_rad)
            places = slots[:, :2] @ np.array([[c, s], [-s, c]]) + (robot.x_m, robot.y_m)
            truths = camera.pixel_from_field(places, options.robots.height_m)
            scales = np.sqrt(camera.pixels_per_square_metre(places, options.robots.height_m))
            for truth, radius in zip(truths, 0.5 * slots[:, 2] * scales, strict=True):
                start = centers[np.hypot(*(centers - truth).T).argmin()]
                if robot.in_picture and math.dist(start, truth) < 1.0:
                    x, y, sd = refined_circle(seen, float(start[0]), float(start[1]), float(radius), memory)
                    refined.append((x - truth[0], y - truth[1]))
                    plain.append(start - truth)
                    sds.append(sd)
    source.close()
    return np.array(refined), np.array(plain), np.array(sds)


@pytest.mark.slow
def test_rendered_dots_are_four_times_as_exact_as_centroids_and_known_as_well() -> None:
    options = {"synthetic.exposure_ms": 0.0, "camera.rate_hz": 5.0}
    refined, plain, sds = markers(load_settings(options=options), 30)
    assert len(refined) > 1000
    rms, centroid_rms = math.sqrt(float((refined**2).mean())), math.sqrt(float((plain**2).mean()))
    assert rms < 0.03
    assert rms < centroid_rms / 3.0
    assert 0.7 <= float(((refined**2).sum(axis=1) / 2.0 / sds**2).mean()) <= 1.4
