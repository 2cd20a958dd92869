"""Masked pixels are background to both segmentations, frame after frame, and to blobs that reach into a mask."""

import numpy as np
import pytest

from bench.segmenters import ReferenceSegmenter, RowScanSegmenter
from tests.blobs.test_row_scan import PREFILTER, TABLE, settings, tall
from tests.blobs.test_run_lengths import picture
from vision_core.blobs.bits import bits_of
from vision_core.geometry import Mask

WIDTH, HEIGHT = 150, 60


def labels(seed: int) -> np.ndarray:
    """Boxes at random places."""
    rng = np.random.default_rng(seed)
    drawn = np.zeros((HEIGHT, WIDTH), dtype=np.int64)
    for _ in range(25):
        x, y, wide, high = rng.integers(0, [WIDTH, HEIGHT, 25, 15])
        drawn[y : y + high, x : x + wide] = 1
    return drawn


@pytest.fixture
def masked() -> Mask:
    mask = np.zeros((HEIGHT, WIDTH), dtype=np.bool_)
    mask[10:30, 50:110] = True
    mask[40:, :20] = True
    mask[5:55:3, 130] = True
    return mask


@pytest.mark.parametrize("share", [1.0, 0.01], ids=["row scan", "over the limit of the flood"])
def test_the_blobs_are_those_of_a_picture_without_the_masked_pixels(masked: Mask, share: float) -> None:
    chosen = settings(max_flood_fraction=share)
    fast = RowScanSegmenter(WIDTH, HEIGHT, chosen, 1, bits_of(masked))
    slow = ReferenceSegmenter(WIDTH, HEIGHT, chosen, bits_of(masked))
    plain = ReferenceSegmenter(WIDTH, HEIGHT, chosen)
    for seed in range(20):
        drawn = labels(seed)
        expected, _ = plain.segment(picture(np.where(masked, 0, drawn)), TABLE)
        for segmenter, found in (
            (fast, fast.segment(picture(drawn), TABLE, PREFILTER)),
            (slow, slow.segment(picture(drawn), TABLE)),
        ):
            assert found == (expected, True)
            assert tall(segmenter.blobs[:expected], 1) == tall(plain.blobs[:expected], 1)


def test_bits_are_those_of_the_mask(masked: Mask) -> None:
    bits = bits_of(masked)
    assert bits is not None
    assert bits.shape == (HEIGHT, 3)
    there = [(bits[y, x >> 6] >> np.uint64(x & 63)) & np.uint64(1) for y in range(HEIGHT) for x in range(WIDTH)]
    assert (np.array(there, dtype=np.bool_).reshape(masked.shape) == masked).all()
    assert bits_of(None) is None
