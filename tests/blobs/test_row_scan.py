"""The row scan finds the blobs of the reference, whatever their shape; windows leave none of them halved."""

from collections.abc import Iterable
from pathlib import Path

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import settings as examples
from hypothesis import strategies as st
from numpy.typing import NDArray

from bench.segmenters import ReferenceSegmenter, RowScanSegmenter
from tests.blobs.test_run_lengths import blue_table, picture
from tests.conftest import ROOT
from vision_core.blobs.row_scan import min_height_px, segment_picture
from vision_core.capture.source import open_source
from vision_core.clock import MonotonicClock
from vision_core.color.lookup_table import compile_color_table
from vision_core.color.prefilter import prefilter_from
from vision_core.geometry import Bytes, frozen
from vision_core.models.camera_setup import CameraSetup
from vision_core.settings.schema import BlobSettings
from vision_core.types.colors import ColorTable
from vision_core.types.prefilter import CONDITIONS, ColorPrefilter
from vision_core.types.tables import Table
from vision_core.venues.loader import load_settings

Labels = NDArray[np.int64]
Rows = set[tuple[float, ...]]

TABLE = blue_table()
PREFILTER = prefilter_from(TABLE)
KINDS = ("disc", "ring", "worm", "diagonal", "comb", "bar")


def settings(**changes: float) -> BlobSettings:
    values = {
        "max_runs": 20000,
        "max_blobs": 5000,
        "row_step": 0.55,
        "scan_band": 0.1,
        "max_flood_fraction": 1.0,
        **changes,
    }
    return BlobSettings(min_area_px=int(values.pop("min_area_px", 1)), **values)  # type: ignore[arg-type]


def tall(blobs: Table, height_px: int) -> Rows:
    rows = blobs[blobs["bottom"] - blobs["top"] + 1 >= height_px].tolist()
    assert len(set(rows)) == len(rows), "a blob is there twice"
    return set(rows)


def reference(pixels: Bytes, table: ColorTable, chosen: BlobSettings) -> Table:
    height, width, _ = pixels.shape
    segmenter = ReferenceSegmenter(width, height, chosen)
    count, complete = segmenter.segment(pixels, table)
    assert complete
    return segmenter.blobs[:count]


def assert_same(pixels: Bytes, table: ColorTable, prefilter: ColorPrefilter, apart: int, chosen: BlobSettings) -> None:
    """The whole frame at once: every blob that is tall enough, and no blob that the reference has not."""
    height, width, _ = pixels.shape
    expected = reference(pixels, table, chosen)
    fast = RowScanSegmenter(width, height, chosen, apart)
    count, complete = fast.segment(pixels, table, prefilter)
    assert complete
    assert tall(fast.blobs[:count], apart) == tall(expected, apart)
    assert tall(fast.blobs[:count], 1) <= tall(expected, 1)


def draw(labels: Labels, kind: str, rng: np.random.Generator) -> None:
    """Something of one class anywhere, also over the border."""
    height, width = labels.shape
    v, u = np.indices(labels.shape)
    x, y, size, number = rng.integers(width), rng.integers(height), rng.integers(1, 15), rng.integers(1, 4)
    distance = np.hypot(u - x, v - y)
    if kind == "disc":
        labels[distance <= size] = number
    elif kind == "ring":
        labels[(distance <= size) & (distance >= size - 2)] = number
    elif kind == "diagonal":
        labels[(u - x == (v - y) * rng.choice([-1, 1])) & (distance < 2 * size)] = number
    elif kind == "comb":
        labels[(abs(u - x) < size) & (abs(v - y) < size) & ((u % 2 == 0) | (v == y))] = number
    elif kind == "bar":
        labels[(abs(v - y) < 2) & (u >= x)] = number
    else:
        for _ in range(12 * size):
            labels[y, x] = number
            x, y = np.clip(x + rng.integers(-1, 2), 0, width - 1), np.clip(y + rng.integers(-1, 2), 0, height - 1)


def drawn(width: int, height: int, kinds: Iterable[str], seed: int) -> Bytes:
    labels = np.zeros((height, width), dtype=np.int64)
    rng = np.random.default_rng(seed)
    for kind in kinds:
        draw(labels, kind, rng)
    return picture(labels)


@examples(max_examples=100, deadline=None, derandomize=True)
@given(
    width=st.integers(1, 200), height=st.integers(1, 90), apart=st.integers(1, 12),
    kinds=st.lists(st.sampled_from(KINDS), max_size=12), seed=st.integers(0, 2**32 - 1),
)  # fmt: skip
def test_every_tall_blob_is_that_of_the_reference(
    width: int, height: int, apart: int, kinds: list[str], seed: int
) -> None:
    assert_same(drawn(width, height, kinds, seed), TABLE, PREFILTER, apart, settings())


@pytest.mark.parametrize("density", [0.1, 0.4, 0.6, 1.0])
@pytest.mark.parametrize("width", [30, 63, 64, 65, 150])
def test_noise_of_touching_classes(density: float, width: int) -> None:
    rng = np.random.default_rng(round(10 * density) + width)
    labels = rng.integers(1, 4, (60, width)) * (rng.random((60, width)) < density)
    for apart in (1, 3, 7):
        assert_same(picture(labels), TABLE, PREFILTER, apart, settings())
        assert_same(picture(np.minimum(labels, 1)), TABLE, PREFILTER, apart, settings(min_area_px=5))


def test_windows_find_what_they_touch_and_find_it_whole() -> None:
    chosen, apart = settings(scan_band=0.001), 4
    for seed in range(30):
        rng = np.random.default_rng(seed)
        pixels = drawn(200, 90, rng.choice(KINDS, 10).tolist(), seed)
        expected = tall(reference(pixels, TABLE, chosen), 1)
        low = np.column_stack([rng.integers(-20, 200, 6), rng.integers(-20, 90, 6)])
        windows = np.hstack([low, low + rng.integers(0, 90, (6, 2))]).astype(np.int32)
        fast = RowScanSegmenter(200, 90, chosen, apart)
        count, complete = fast.segment(pixels, TABLE, PREFILTER, windows)
        found = tall(fast.blobs[:count], 1)
        assert complete
        assert found <= expected
        for blob in expected - found:
            left, top, right, bottom = (int(side) for side in blob[4:])
            for window in windows.tolist():
                inside = window[0] <= left and right <= window[2] and window[1] <= top and bottom <= window[3]
                assert not (inside and bottom - top + 1 >= apart)


@pytest.mark.parametrize("share", [0.1, 0.3, 1.0])
def test_the_scan_band_has_been_everywhere_after_its_round(share: float) -> None:
    chosen, apart = settings(scan_band=share), 3
    pixels = drawn(150, 90, KINDS * 2, 5)
    expected = tall(reference(pixels, TABLE, chosen), apart)
    fast = RowScanSegmenter(150, 90, chosen, apart)
    for start in range(3):
        found: Rows = set()
        for _ in range(int(np.ceil(1 / share))):
            count, _ = fast.segment(pixels, TABLE, PREFILTER, np.zeros((0, 4), dtype=np.int32))
            found |= tall(fast.blobs[:count], apart)
        assert found == expected, start


def test_over_budget_the_reference_takes_over() -> None:
    pixels = drawn(150, 90, KINDS * 3, 6)
    chosen = settings(max_flood_fraction=0.01)
    fast = RowScanSegmenter(150, 90, chosen, 3)
    for windows in (None, np.array([[0, 0, 149, 89]], dtype=np.int32)):
        count, complete = fast.segment(pixels, TABLE, PREFILTER, windows)
        assert complete
        assert fast.blobs[:count].tolist() == reference(pixels, TABLE, chosen).tolist()


def test_overflow_is_reported() -> None:
    labels = np.zeros((60, 60), dtype=np.int64)
    labels[::2, ::2] = 1
    for changes in ({"max_blobs": 50}, {"max_runs": 100}):
        fast = RowScanSegmenter(60, 60, settings(**changes), 1)
        count, complete = fast.segment(picture(labels), TABLE, PREFILTER)
        assert not complete
        assert count == min(100, *changes.values())


def test_a_prefilter_that_rejects_everything_finds_nothing() -> None:
    none_dark = np.where(np.arange(CONDITIONS) == CONDITIONS - 1, 0, 255).astype(np.uint8)
    reject = ColorPrefilter(frozen(np.full(CONDITIONS, 255, dtype=np.uint8)), frozen(none_dark))
    fast = RowScanSegmenter(100, 60, settings(), 2)
    assert fast.segment(drawn(100, 60, KINDS, 1), TABLE, reject) == (0, True)


def test_min_height() -> None:
    assert min_height_px(7.87, 0.55) == 4
    assert min_height_px(0.5, 0.55) == 1


def test_a_picture_of_another_size_raises() -> None:
    with pytest.raises(AssertionError, match="is not"):
        RowScanSegmenter(30, 10, settings(), 2).segment(np.zeros((30, 10, 3), dtype=np.uint8), TABLE, PREFILTER)


def test_rendered_frames() -> None:
    chosen = load_settings()
    table = compile_color_table(chosen.colors)
    prefilter = prefilter_from(table)
    source = open_source(chosen, CameraSetup.from_settings(chosen), MonotonicClock(), paced=False)
    pixels = np.empty((chosen.camera.height_px, chosen.camera.width_px, 3), dtype=np.uint8)
    compiled = len(segment_picture.signatures)  # type: ignore[attr-defined]
    for _ in range(3):
        source.grab(pixels)
        for apart in (1, 3, 4, 7):
            assert_same(pixels, table, prefilter, apart, chosen.blobs)
    source.close()
    versions = len(segment_picture.signatures)  # type: ignore[attr-defined]
    assert versions <= compiled + 1  # the masked one is there where this process has run its test


@pytest.mark.slow
@pytest.mark.parametrize("venue", sorted(path.stem for path in (ROOT / "config" / "venues").glob("*.toml")))
def test_real_pictures(venue: str, real_pictures: Path) -> None:
    files = sorted(path for path in (real_pictures / venue).glob("*") if path.suffix in {".jpg", ".png"})[:6]
    chosen = load_settings(venue=venue)
    table = compile_color_table(chosen.colors)
    prefilter = prefilter_from(table)
    for path in files:
        pixels = cv2.imread(str(path))
        assert pixels is not None
        for apart in (3, 6):
            assert_same(np.ascontiguousarray(pixels), table, prefilter, apart, chosen.blobs)
