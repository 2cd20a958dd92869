"""Region growing against the segmentation of the whole picture, its validations, and following an object."""

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from msgspec.structs import replace
from numpy.typing import NDArray

from bench.region_growing.region import (
    LAST_SERIAL,
    NOT_FOUND,
    GrowingBuffers,
    color_of_classes,
    color_of_seed,
    grow,
    growing_buffers,
    side_of_ring,
    step_for,
)  # fmt: skip
from bench.region_growing.tracker import GrowingLimits, GrowingTracker
from bench.segmenters import ReferenceSegmenter
from vision_core.clock import Instant, after
from vision_core.geometry import Bytes
from vision_core.types.colors import ColorTable, References
from vision_core.types.tables import Table
from vision_core.venues.loader import load_settings

CLASSES = ((np.arange(65536) >> 11) * 8 // 64).astype(np.uint8)
CLASSES.setflags(write=False)
TABLE = ColorTable(
    ("", "a", "b", "c"), CLASSES, np.zeros((4, 3), np.uint8), (), References(np.zeros((4, 2)), np.zeros((4, 3)))
)
"""Classes 1..3 are the blue levels 64, 128 and 192; everything darker is class 0."""
A, B = color_of_classes(1), color_of_classes(2)
START = Instant(1_000_000_000)
Labels = NDArray[np.int64]
Box = tuple[int, int, int, int]


def picture(labels: Labels) -> Bytes:
    pixels = np.zeros((*labels.shape, 3), dtype=np.uint8)
    pixels[..., 0] = labels * 64
    pixels.setflags(write=False)
    return pixels


def found(
    labels: Labels, start: tuple[float, float], limits: GrowingLimits, buffers: GrowingBuffers | None = None
) -> tuple[float, Any]:
    height, width = labels.shape
    used = buffers or growing_buffers(width, height)
    around = A if limits.around is None else limits.around
    x, y = float(start[0]), float(start[1])
    share = grow(picture(labels), CLASSES, x, y, A, around, limits.row(max(width, height)), used)
    return share, used.blob[0]


def segmented(labels: Labels) -> Table:
    height, width = labels.shape
    chosen = replace(load_settings().blobs, min_area_px=1)
    segmenter = ReferenceSegmenter(width, height, chosen)
    count, _ = segmenter.segment(picture(labels), TABLE)
    return segmenter.blobs[:count]


def disc(labels: Labels, x: float, y: float, radius: float, number: int = 1) -> NDArray[np.bool_]:
    v, u = np.indices(labels.shape)
    mask: NDArray[np.bool_] = np.asarray((u - x) ** 2 + (v - y) ** 2 <= radius**2)
    labels[mask] = number
    return mask


def box_of(blob: Any) -> Box:
    return int(blob["left"]), int(blob["top"]), int(blob["right"]), int(blob["bottom"])


@pytest.mark.parametrize("density", [0.2, 0.4, 0.6, 0.95])
def test_a_region_equals_the_blob_of_the_reference_segmentation(density: float) -> None:
    rng, buffers = np.random.default_rng(4), growing_buffers(53, 37)
    for _ in range(10):
        labels = rng.integers(1, 4, (37, 53)) * (rng.random((37, 53)) < density)
        blobs = segmented(labels)
        expected = np.array(blobs[blobs["color"] == 1].tolist())
        for y, x in np.argwhere(labels == 1)[::7].tolist():
            share, blob = found(labels, (x, y), GrowingLimits(1, 9999), buffers=buffers)
            left, top, right, bottom = box_of(blob)
            assert (share, blob["color"]) == (1.0, 1)
            assert left <= x <= right
            assert top <= y <= bottom
            assert np.isclose(expected, blob.tolist()).all(axis=1).sum() == 1


def test_every_pixel_of_a_region_leads_to_the_same_region() -> None:
    comb = np.zeros((20, 41), dtype=np.int64)
    comb[:, ::2] = 1
    comb[-1] = 1
    buffers = growing_buffers(41, 20)
    rows = [
        tuple(found(comb, (x, y), GrowingLimits(1, 9999), buffers=buffers)[1].tolist()) for y, x in np.argwhere(comb)
    ]
    assert set(rows) == {rows[0]}
    assert rows[0][1] == (comb == 1).sum()


@pytest.mark.parametrize("step", [1, 2, 5])
@pytest.mark.parametrize(("x", "y"), [(0, 0), (7, 3), (19, 11), (12, 11)])
def test_rings_meet_every_point_of_their_grid_once_the_nearest_first(x: int, y: int, step: int) -> None:
    width, height, met, last = 20, 12, [], 0
    for ring in range(25):
        for side in range(4):
            u, v, du, dv, points = side_of_ring(ring, side, x, y, step, width, height)
            for point in range(points):
                place = u + point * du, v + point * dv
                assert max(abs(place[0] - x), abs(place[1] - y)) == ring * step
                met.append(place)
                last = ring
    grid = {(u, v) for u in range(x % step, width, step) for v in range(y % step, height, step)}
    assert len(met) == len(set(met))
    assert set(met) == grid
    assert last * step <= max(x, y, width - x, height - y)


@settings(deadline=None, max_examples=60)
@given(st.integers(4, 400), st.floats(0.0, 1.0), st.floats(0.0, 1.0), st.integers(0, 119), st.integers(0, 89))
def test_no_disc_fits_between_the_points_of_the_rings(area: int, dx: float, dy: float, x: int, y: int) -> None:
    labels = np.zeros((90, 120), dtype=np.int64)
    mask = disc(labels, 60.0 + dx, 45.0 + dy, math.sqrt(area / math.pi))
    limits = GrowingLimits(max(1, area * 4 // 5), area * 2)
    share, blob = found(labels, (x, y), limits)
    assert (share != NOT_FOUND) == (limits.min_area_px <= mask.sum() <= limits.max_area_px)
    if share != NOT_FOUND:
        assert blob["area_px"] == mask.sum()


@settings(deadline=None, max_examples=60)
@given(st.lists(st.tuples(st.integers(0, 119), st.integers(0, 89), st.floats(1.0, 9.0)), max_size=12), st.data())
def test_the_nearest_valid_region_is_found(discs: list[tuple[int, int, float]], data: st.DataObject) -> None:
    labels = np.zeros((90, 120), dtype=np.int64)
    for x, y, radius in discs:
        disc(labels, x, y, radius)
    start = data.draw(st.tuples(st.integers(0, 119), st.integers(0, 89)))
    limits = GrowingLimits(20, 120)
    blobs, step = segmented(labels), step_for(20)
    rings = {}
    for blob in blobs:
        if 20 <= blob["area_px"] <= 120:
            left, top, right, bottom = box_of(blob)
            distance = max(left - start[0], start[0] - right, top - start[1], start[1] - bottom, 0)
            rings[left, top, right, bottom] = distance
    share, blob = found(labels, start, limits)
    assert (share == NOT_FOUND) == (not rings)
    if rings:  # its box is at most two rings and its own hollow corner farther than the nearest one
        assert rings[box_of(blob)] <= min(rings.values()) + 2 * step + 12


def test_a_region_above_the_largest_area_is_rejected_as_a_whole() -> None:
    labels = np.zeros((90, 120), dtype=np.int64)
    labels[10:60, 10:80] = 1
    assert found(labels, (40, 30), GrowingLimits(20, 100))[0] == NOT_FOUND
    disc(labels, 100, 75, 4.0)
    share, blob = found(labels, (40, 30), GrowingLimits(20, 100))
    assert share == 1.0
    assert (blob["x_px"], blob["y_px"]) == (100.0, 75.0)


def test_the_budget_limits_the_pixels_that_are_grown() -> None:
    labels = np.ones((90, 120), dtype=np.int64)
    buffers = growing_buffers(120, 90)
    assert found(labels, (60, 45), GrowingLimits(20, 100, budget_px=500), buffers=buffers)[0] == NOT_FOUND
    assert 500 < int((buffers.stamps & 1).sum()) < 500 + 2 * 120
    checkered = np.indices((90, 120)).sum(axis=0) % 2
    assert found(checkered, (60, 45), GrowingLimits(20, 100), buffers=buffers)[0] == NOT_FOUND


def dilated(mask: NDArray[np.bool_], layers: int) -> NDArray[np.bool_]:
    for _ in range(layers):
        wide = np.pad(mask, 1)
        shifts = [np.roll(wide, (v, u), axis=(0, 1)) for v in (-1, 0, 1) for u in (-1, 0, 1)]
        mask = np.logical_or.reduce(shifts)[1:-1, 1:-1]
    return mask


@pytest.mark.parametrize(("x", "y"), [(30, 30), (2, 3), (57, 30)])
@pytest.mark.parametrize(("gap", "ring"), [(0, 1), (2, 2), (1, 4)])
def test_the_surroundings_are_the_layers_beyond_the_gap(x: int, y: int, gap: int, ring: int) -> None:
    labels = 2 * (np.random.default_rng(1).random((60, 60)) < 0.6).astype(np.int64)
    mask = disc(labels, x, y, 5.0)
    layers = dilated(mask, gap + ring) & ~dilated(mask, gap)
    limits = GrowingLimits(10, 500, around=B, min_around=0.0, gap_px=gap, ring_px=ring)
    assert found(labels, (x, y), limits)[0] == pytest.approx((labels[layers] == 2).mean())


def test_an_object_in_the_wrong_surroundings_is_passed_over() -> None:
    labels = np.zeros((90, 120), dtype=np.int64)
    disc(labels, 90, 45, 15.0, number=2)
    disc(labels, 30, 45, 5.0)
    disc(labels, 90, 45, 5.0)
    share, blob = found(labels, (30, 45), GrowingLimits(10, 500, around=B))
    assert (share, blob["x_px"]) == (1.0, 90.0)
    assert found(labels, (30, 45), GrowingLimits(10, 500))[1]["x_px"] == 30.0


def test_an_object_in_the_surroundings_of_a_rejected_region_is_found() -> None:
    labels = np.full((60, 60), 2, dtype=np.int64)
    labels[:, :20] = 0  # the left one is half surrounded
    disc(labels, 20, 30, 4.0)
    disc(labels, 30, 30, 4.0)
    limits = GrowingLimits(10, 500, around=B, min_around=0.8, gap_px=0, ring_px=3)
    share, blob = found(labels, (20, 30), limits)
    assert 0.8 < share < 1.0
    assert blob["x_px"] == 30.0


def test_a_seed_separates_colors_that_share_a_cell_of_the_table() -> None:
    pixels = np.full((60, 80, 3), (64, 64, 64), dtype=np.uint8)
    pixels[20:30, 20:30] = (64, 66, 70)  # all three lie in the same cell as the ground
    pixels[20:30, 50:60] = (70, 65, 64)
    index = [(int(b) >> 3, int(g) >> 2, int(r) >> 3) for b, g, r in (pixels[0, 0], pixels[25, 25], pixels[25, 55])]
    assert len(set(index)) == 1
    tracker = GrowingTracker(80, 60, color_of_seed((70.0, 65.0, 64.0), 4.0, 2.0), GrowingLimits(50, 200))
    blob = tracker.follow(pixels, START)
    assert blob is not None
    assert (blob["x_px"][0], blob["y_px"][0], blob["area_px"][0]) == (54.5, 24.5, 100)


def test_seeds_bound_chroma_and_luma() -> None:
    def seen(bgr: tuple[int, int, int]) -> bool:
        pixels = np.zeros((20, 20, 3), dtype=np.uint8)
        pixels[5:15, 5:15] = bgr
        return GrowingTracker(20, 20, seed, GrowingLimits(50, 200)).follow(pixels, START) is not None

    seed = color_of_seed((40.0, 120.0, 220.0), 30.0, 15.0)
    assert seen((40, 120, 220))
    assert seen((60, 140, 240))  # the same color in more light
    assert not seen((100, 180, 255))
    assert not seen((40, 160, 190))


def rolling(frame: int) -> tuple[float, float]:
    return 20.0 + 6.0 * frame, 30.0 + 2.0 * frame


def test_a_tracker_follows_predicts_loses_and_finds_again() -> None:
    tracker = GrowingTracker(320, 240, A, GrowingLimits(30, 120), TABLE)
    assert tracker.lost
    for frame in range(60):
        labels = np.zeros((240, 320), dtype=np.int64)
        at, (x, y) = after(START, frame / 30.0), rolling(frame % 30)
        hidden = 10 <= frame < 15
        if not hidden:
            disc(labels, x, y, 5.0)
        predicted = tracker.predict(at)
        blob = tracker.follow(picture(labels), at)
        assert (blob is None) == tracker.lost == hidden
        if blob is not None:
            assert (blob["x_px"][0], blob["y_px"][0]) == pytest.approx((x, y), abs=1e-9)
        if frame % 30 >= 2 and not 9 < frame < 17:
            assert predicted == pytest.approx((x, y), abs=1e-6)
        if hidden:
            assert tracker.predict(after(at, 1.0)) == pytest.approx(rolling(9))


def test_a_similar_object_beside_it_does_not_replace_the_object() -> None:
    tracker = GrowingTracker(320, 240, A, GrowingLimits(30, 120), TABLE)
    for frame in range(40):
        labels = np.zeros((240, 320), dtype=np.int64)
        disc(labels, *rolling(frame), 5.0)
        if frame:
            disc(labels, 140.0, 82.0, 5.0)  # 12 px from where it passes
        blob = tracker.follow(picture(labels), after(START, frame / 30.0))
        assert blob is not None
        assert blob["x_px"][0] == pytest.approx(rolling(frame)[0])


def test_during_patience_a_distant_object_does_not_replace_the_hidden_one() -> None:
    limits = GrowingLimits(30, 120, near_px=20.0, patience_s=0.5)
    tracker = GrowingTracker(320, 240, A, limits, TABLE, start_px=(50.0, 60.0))
    assert tracker.last_px == (50.0, 60.0)
    both, other = np.zeros((2, 240, 320), dtype=np.int64)
    disc(both, 50.0, 60.0, 5.0)
    for labels in (both, other):
        disc(labels, 150.0, 60.0, 5.0)
    for frame in range(40):
        blob = tracker.follow(picture(other if frame else both), after(START, frame / 30.0))
        assert (None if blob is None else blob["x_px"][0]) == (50.0 if frame == 0 else None if frame <= 15 else 150.0)


def test_stamps_are_cleared_before_their_numbers_overflow() -> None:
    labels = np.zeros((30, 40), dtype=np.int64)
    disc(labels, 20, 15, 4.0)
    buffers = growing_buffers(40, 30)
    expected = found(labels, (0, 0), GrowingLimits(10, 100), buffers=buffers)[1].tolist()
    buffers.stamps[:] = np.iinfo(np.int32).max
    buffers.serial[0] = LAST_SERIAL
    assert found(labels, (0, 0), GrowingLimits(10, 100), buffers=buffers)[1].tolist() == expected
    assert buffers.serial[0] == 1


def test_the_kernel_is_compiled_once() -> None:
    table = ColorTable(TABLE.names, CLASSES.copy(), TABLE.mean_bgr, (), TABLE.references)
    labels = np.zeros((30, 40), dtype=np.int64)
    disc(labels, 20, 15, 4.0)
    for pixels in (picture(labels), picture(labels).copy(), picture(labels)[:, ::-1]):
        GrowingTracker(40, 30, A, GrowingLimits(10, 100), table).follow(pixels, START)
    GrowingTracker(40, 30, color_of_seed((0.0, 0.0, 0.0), 1.0, 1.0), GrowingLimits(10, 100)).follow(pixels, START)
    kernel: Any = grow
    assert len(kernel.signatures) == 1


def test_a_picture_of_another_size_raises() -> None:
    with pytest.raises(AssertionError, match="another size"):
        GrowingTracker(40, 30, A, GrowingLimits(10, 100), TABLE).follow(np.zeros((40, 30, 3), dtype=np.uint8), START)
