"""Blobs against an independent labelling, and what happens when the tables run over."""

import numpy as np
import pytest
from numpy.typing import NDArray

from bench.segmenters import ReferenceSegmenter
from vision_core.geometry import Bytes
from vision_core.settings.schema import BlobSettings
from vision_core.types.colors import ColorTable, References
from vision_core.types.tables import Table

GREYS = 4
"""Classes 1..3 are the blue levels 64, 128 and 192; everything darker is class 0."""

Row = tuple[int, int, float, float, int, int, int, int]


def blue_table() -> ColorTable:
    classes = ((np.arange(65536) >> 11) * 8 // 64).astype(np.uint8)
    return ColorTable(
        ("", "a", "b", "c"),
        classes,
        np.zeros((GREYS, 3), np.uint8),
        (),
        References(np.zeros((GREYS, 2)), np.zeros((GREYS, 3))),
    )


def picture(labels: NDArray[np.int64]) -> Bytes:
    pixels = np.zeros((*labels.shape, 3), dtype=np.uint8)
    pixels[..., 0] = labels * 64
    return pixels


def settings(min_area_px: int = 1, max_runs: int = 5000, max_blobs: int = 2000) -> BlobSettings:
    return BlobSettings(
        min_area_px=min_area_px,
        max_runs=max_runs,
        max_blobs=max_blobs,
        row_step=0.55,
        scan_band=0.1,
        max_flood_fraction=0.1,
    )


def segmented(labels: NDArray[np.int64], chosen: BlobSettings | None = None) -> tuple[Table, bool]:
    """The blobs, and whether all had room."""
    height, width = labels.shape
    segmenter = ReferenceSegmenter(width, height, chosen or settings())
    count, complete = segmenter.segment(picture(labels), blue_table())
    return segmenter.blobs[:count], complete


def flooded(labels: NDArray[np.int64]) -> list[Row]:
    """Regions by flood fill, in scan order: class, area, center, box."""
    todo = labels.copy()
    rows = []
    for y, x in np.argwhere(labels > 0).tolist():
        color = todo[y, x]
        if not color:
            continue
        todo[y, x] = 0
        queue, members = [(y, x)], []
        while queue:
            v, u = queue.pop()
            members.append((u, v))
            for q in range(max(v - 1, 0), min(v + 2, labels.shape[0])):
                for p in range(max(u - 1, 0), min(u + 2, labels.shape[1])):
                    if todo[q, p] == color:
                        todo[q, p] = 0
                        queue.append((q, p))
        place = np.array(members)
        (left, top), (right, bottom) = place.min(axis=0).tolist(), place.max(axis=0).tolist()
        mean_x, mean_y = place.mean(axis=0).tolist()
        rows.append((int(color), len(members), mean_x, mean_y, left, top, right, bottom))
    return rows


@pytest.mark.parametrize("density", [0.05, 0.3, 0.45, 0.6, 0.95])
@pytest.mark.parametrize("shape", [(1, 40), (40, 1), (37, 53)])
def test_agrees_with_flood_fill(density: float, shape: tuple[int, int]) -> None:
    rng = np.random.default_rng(round(density * 100) + shape[0])
    for classes in (1, 3):
        for _ in range(5):
            labels = rng.integers(1, classes + 1, shape) * (rng.random(shape) < density)
            blobs, complete = segmented(labels)
            assert complete
            expected = flooded(labels)
            assert len(blobs) == len(expected)
            assert np.array(blobs.tolist()) == pytest.approx(np.array(expected), abs=1e-9)


def test_a_comb_becomes_one_blob() -> None:
    comb = np.zeros((20, 41), dtype=np.int64)
    comb[:, ::2] = 1
    comb[-1] = 1
    comb[0, ::4] = 2
    blobs, _ = segmented(comb)
    assert np.array(blobs.tolist()) == pytest.approx(np.array(flooded(comb)))
    assert (blobs["color"] == 1).sum() == 1


def test_diagonal_neighbors_touch() -> None:
    assert len(segmented(np.eye(9, dtype=np.int64))[0]) == 1
    assert len(segmented(np.eye(9, dtype=np.int64)[::-1].copy())[0]) == 1


def test_small_blobs_are_left_out() -> None:
    labels = np.zeros((10, 30), dtype=np.int64)
    labels[2, 2:5] = 1
    labels[2, 10:14] = 1
    labels[6, 20] = 2
    assert segmented(labels, settings(min_area_px=4))[0]["area_px"].tolist() == [4]


def test_no_blob_of_the_previous_picture_remains() -> None:
    rng = np.random.default_rng(3)
    segmenter = ReferenceSegmenter(60, 40, settings())
    for density in (0.6, 0.05, 0.3):
        labels = rng.integers(1, 4, (40, 60)) * (rng.random((40, 60)) < density)
        count, complete = segmenter.segment(picture(labels), blue_table())
        blobs, fitted = segmented(labels)
        assert segmenter.blobs[:count].tolist() == blobs.tolist()
        assert complete == fitted


@pytest.mark.parametrize(("max_runs", "max_blobs"), [(100, 2000), (5000, 10)])
def test_overflow_keeps_what_fits_and_says_so(max_runs: int, max_blobs: int) -> None:
    labels = np.zeros((41, 41), dtype=np.int64)
    labels[::2, ::2] = 1
    blobs, complete = segmented(labels, settings(max_runs=max_runs, max_blobs=max_blobs))
    assert not complete
    assert len(blobs) == min(max_runs, max_blobs)
    assert blobs.tolist() == flooded(labels)[: len(blobs)]
    full, complete = segmented(labels, settings(max_runs=441, max_blobs=441))
    assert complete
    assert len(full) == 441


def test_a_picture_of_another_size_raises() -> None:
    with pytest.raises(AssertionError, match="is not"):
        ReferenceSegmenter(30, 10, settings()).segment(np.zeros((30, 10, 3), dtype=np.uint8), blue_table())
