"""PNG files that another reader reads."""

from pathlib import Path

import numpy as np
import pytest

from vision_core.client.png import write_png
from vision_core.errors import SourceError
from vision_core.native.opencv import read_picture


@pytest.mark.parametrize("shape", [(1, 1, 3), (5, 7, 3), (240, 320, 3)])
def test_what_is_written_is_read_by_opencv(tmp_path: Path, shape: tuple[int, int, int]) -> None:
    rgb = np.random.default_rng(3).integers(0, 256, shape, dtype=np.uint8)
    write_png(tmp_path / "a.png", rgb)
    np.testing.assert_array_equal(read_picture(tmp_path / "a.png")[:, :, ::-1], rgb)


def test_a_file_that_cannot_be_written_is_named(tmp_path: Path) -> None:
    with pytest.raises(SourceError, match="no/such"):
        write_png(tmp_path / "no/such/a.png", np.zeros((1, 1, 3), dtype=np.uint8))
