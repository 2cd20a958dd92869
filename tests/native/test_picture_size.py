"""The header says what decoding gives, and no damaged header raises."""

import struct
from pathlib import Path

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from vision_core.errors import SourceError
from vision_core.native.opencv import MAX_SIDE_PX, check_picture_size, read_picture, write_picture
from vision_core.native.picture_size import READERS, picture_size

WIDTH, HEIGHT = 67, 41


def encoded(ending: str, *options: int) -> bytes:
    pixels = np.random.default_rng(1).integers(0, 255, (HEIGHT, WIDTH, 3), dtype=np.uint8)
    fine, data = cv2.imencode(ending, pixels, list(options))
    assert fine
    return data.tobytes()


FORMATS = {
    "png": encoded(".png"),
    "jpeg": encoded(".jpg"),
    "progressive jpeg": encoded(".jpg", cv2.IMWRITE_JPEG_PROGRESSIVE, 1),
    "bmp": encoded(".bmp"),
    "tiff": encoded(".tif"),
    "lossy webp": encoded(".webp", cv2.IMWRITE_WEBP_QUALITY, 80),
    "lossless webp": encoded(".webp", cv2.IMWRITE_WEBP_QUALITY, 101),
}


@pytest.mark.parametrize("data", FORMATS.values(), ids=FORMATS.keys())
def test_every_format_says_its_size(data: bytes) -> None:
    assert picture_size(data) == (WIDTH, HEIGHT)


def test_sizes_of_variants_that_opencv_does_not_write() -> None:
    assert picture_size(b"RIFF????WEBPVP8X" + bytes(8) + bytes([66, 0, 0, 40, 0, 0])) == (WIDTH, HEIGHT)
    assert picture_size(b"BM" + bytes(12) + struct.pack("<IHH", 12, WIDTH, HEIGHT)) == (WIDTH, HEIGHT)
    assert picture_size(b"BM" + bytes(12) + struct.pack("<Iii", 40, WIDTH, -HEIGHT)) == (WIDTH, HEIGHT)
    entries = struct.pack(">HHII", 256, 4, 1, WIDTH) + struct.pack(">HHII", 257, 4, 1, HEIGHT)
    assert picture_size(b"MM\0*" + struct.pack(">IH", 8, 2) + entries) == (WIDTH, HEIGHT)


@given(st.sampled_from([start for start, _ in READERS]), st.binary(max_size=80))
def test_garbage_gives_a_size_or_none(start: bytes, rest: bytes) -> None:
    size = picture_size(start + rest)
    assert size is None or all(isinstance(side, int) for side in size)


@pytest.mark.parametrize("data", FORMATS.values(), ids=FORMATS.keys())
def test_a_header_that_is_cut_off_gives_none(data: bytes) -> None:
    assert picture_size(data[:8]) is None


def test_a_gigantic_picture_is_refused_by_its_header() -> None:
    side = struct.pack(">II", 2 * MAX_SIDE_PX, 2 * MAX_SIDE_PX)
    header = FORMATS["png"][:16] + side
    with pytest.raises(SourceError, match=r"found: 16384x16384 px; accepted: sides of 1 to 8192 px"):
        check_picture_size("picture", header, None)
    with pytest.raises(SourceError, match=r"found: 16384x16384 px; accepted: 640x480"):
        check_picture_size("picture", header, (640, 480))


def test_a_picture_of_another_size_than_wanted_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "a.png"
    path.write_bytes(FORMATS["png"])
    assert read_picture(path, (WIDTH, HEIGHT)).shape == (HEIGHT, WIDTH, 3)
    with pytest.raises(SourceError, match="found: 67x41 px; accepted: 640x480"):
        read_picture(path, (640, 480))
    with pytest.raises(SourceError, match="found: 67x41 px; accepted: 41x67"):
        read_picture(path, (HEIGHT, WIDTH))  # turned, which Exif data might do but this file has none


def test_a_damaged_picture_is_named(tmp_path: Path) -> None:
    path = tmp_path / "a.png"
    write_picture(path, np.zeros((HEIGHT, WIDTH, 3), dtype=np.uint8))
    path.write_bytes(path.read_bytes()[:40])
    with pytest.raises(SourceError, match="found: a damaged picture"):
        read_picture(path)
