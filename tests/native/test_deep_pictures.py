"""Pictures of 16 bits per channel, of which a camera filled 10, 12 or all."""

from pathlib import Path

import cv2
import numpy as np
import pytest

from vision_core.errors import SourceError
from vision_core.native.opencv import read_picture

LEVELS = np.random.default_rng(1).integers(0, 256, (20, 30, 3), dtype=np.uint8)


@pytest.mark.parametrize("ending", [".png", ".tif"])
@pytest.mark.parametrize("bits", [10, 12, 16])
def test_the_bits_that_were_filled_are_read(tmp_path: Path, bits: int, ending: str) -> None:
    file = tmp_path / f"deep{ending}"
    cv2.imwrite(str(file), LEVELS.astype(np.uint16) << (bits - 8))
    assert np.array_equal(read_picture(file), LEVELS)


def test_a_dark_picture_of_12_bits_is_not_taken_for_one_of_10(tmp_path: Path) -> None:
    file = tmp_path / "dark.png"
    cv2.imwrite(str(file), (LEVELS // 3).astype(np.uint16) << 4)
    assert np.array_equal(read_picture(file), LEVELS // 3)


def test_a_black_picture_stays_black(tmp_path: Path) -> None:
    file = tmp_path / "black.png"
    cv2.imwrite(str(file), np.full((20, 30, 3), 500, dtype=np.uint16))
    assert read_picture(file).max() == 1


def test_numbers_that_are_no_levels_are_refused(tmp_path: Path) -> None:
    file = tmp_path / "floats.tif"
    cv2.imwrite(str(file), LEVELS.astype(np.float32))
    with pytest.raises(SourceError, match="found: float32 in each channel; accepted: 8 or 16 bits"):
        read_picture(file)
