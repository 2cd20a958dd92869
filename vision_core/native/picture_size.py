"""Width and height of a picture from the header of its file, without decoding it.

A small file may decode to gigabytes (a PNG of one color compresses by a factor of a thousand), so the size is looked
at first. Formats: PNG, JPEG, BMP, TIFF and WebP, as their specifications lay out the headers.
"""

import struct
from collections.abc import Callable

Size = tuple[int, int]

JPEG_FRAMES = frozenset(range(0xC0, 0xD0)) - {0xC4, 0xC8, 0xCC}
"""Markers of a JPEG frame header (SOF0 to SOF15); the three left out are tables."""
JPEG_ALONE = frozenset({0x01, *range(0xD0, 0xD8)})
"""Markers without a length."""
TIFF_WIDTH, TIFF_HEIGHT, TIFF_SHORT = 256, 257, 3
TIFF_ENTRY_BYTES = 12


def picture_size(data: bytes) -> Size | None:
    """Width and height [px] that a picture's header says; None for no known format, or a damaged header.

    data: the beginning of a file, at least up to the header that holds the size.
    """
    for starts_with, size in READERS:
        if data.startswith(starts_with):
            try:
                return size(data)
            except (struct.error, IndexError):
                return None
    return None


def _png(data: bytes) -> Size:
    width, height = struct.unpack_from(">II", data, 16)
    return width, height


def _jpeg(data: bytes) -> Size | None:
    at = 2
    while data[at] == 0xFF:
        marker = data[at + 1]
        if marker == 0xFF:  # a fill byte
            at += 1
        elif marker in JPEG_ALONE:
            at += 2
        elif marker in JPEG_FRAMES:
            height, width = struct.unpack_from(">HH", data, at + 5)
            return width, height
        else:
            at += 2 + max(struct.unpack_from(">H", data, at + 2)[0], 2)
    return None


def _bmp(data: bytes) -> Size:
    if struct.unpack_from("<I", data, 14)[0] == 12:  # the header of OS/2
        width, height = struct.unpack_from("<HH", data, 18)
        return width, height
    width, height = struct.unpack_from("<ii", data, 18)
    return abs(width), abs(height)  # a negative height: rows from the top


def _tiff(data: bytes) -> Size | None:
    order = "<" if data[:2] == b"II" else ">"
    at = struct.unpack_from(f"{order}I", data, 4)[0]
    sides = {}
    for entry in range(struct.unpack_from(f"{order}H", data, at)[0]):
        tag, kind = struct.unpack_from(f"{order}HH", data, at + 2 + TIFF_ENTRY_BYTES * entry)
        value_at = at + 2 + TIFF_ENTRY_BYTES * entry + 8
        sides[tag] = struct.unpack_from(f"{order}{'H' if kind == TIFF_SHORT else 'I'}", data, value_at)[0]
    if TIFF_WIDTH not in sides or TIFF_HEIGHT not in sides:
        return None
    return sides[TIFF_WIDTH], sides[TIFF_HEIGHT]


def _webp(data: bytes) -> Size | None:
    kind = data[12:16]
    if kind == b"VP8X":
        return int.from_bytes(data[24:27], "little") + 1, int.from_bytes(data[27:30], "little") + 1
    if kind == b"VP8L":
        bits = struct.unpack_from("<I", data, 21)[0]
        return (bits & 0x3FFF) + 1, (bits >> 14 & 0x3FFF) + 1
    if kind == b"VP8 ":
        width, height = struct.unpack_from("<HH", data, 26)
        return width & 0x3FFF, height & 0x3FFF
    return None


READERS: tuple[tuple[bytes, Callable[[bytes], Size | None]], ...] = (
    (b"\x89PNG\r\n\x1a\n", _png),
    (b"\xff\xd8", _jpeg),
    (b"BM", _bmp),
    (b"II*\0", _tiff),
    (b"MM\0*", _tiff),
    (b"RIFF", _webp),
)
"""How files of each format begin, and what reads their size."""
