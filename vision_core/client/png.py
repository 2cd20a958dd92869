"""PNG files (ISO/IEC 15948) with NumPy and the standard library: the client has no OpenCV."""

import struct
import zlib
from pathlib import Path

import numpy as np

from vision_core.errors import SourceError
from vision_core.geometry import Bytes

SIGNATURE = b"\x89PNG\r\n\x1a\n"
RGB_8_BITS = (8, 2, 0, 0, 0)
"""Bit depth, color type, compression, filter and interlace method."""


def png_from_rgb(rgb: Bytes) -> bytes:
    """The bytes of a picture's PNG file. rgb: red green blue, shape (height, width, 3)."""
    height, width, _ = rgb.shape
    rows = np.zeros((height, 1 + width * 3), dtype=np.uint8)  # each row begins with its filter: 0, none
    rows[:, 1:] = rgb.reshape(height, -1)
    header = struct.pack(">IIBBBBB", width, height, *RGB_8_BITS)
    body = zlib.compress(rows.tobytes(), 6)
    return SIGNATURE + _chunk(b"IHDR", header) + _chunk(b"IDAT", body) + _chunk(b"IEND", b"")


def write_png(path: Path, rgb: Bytes) -> None:
    """Save a picture, red green blue, shape (height, width, 3). Raises SourceError when the file cannot be written."""
    try:
        path.write_bytes(png_from_rgb(rgb))
    except OSError as error:
        raise SourceError(f"picture {path}", found=error.strerror or str(error)) from None


def _chunk(name: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))
