"""``see`` datagrams in compiled code: byte for byte what ``protocol.see`` says, without its objects.

The law stays ``protocol.see.see_from_view``; a test holds this against it for every option. Edges are written four
directions at a time: 4 x 3 characters are three 32-bit words, little-endian, so they begin at a word's boundary and
the head of a datagram, whose length varies, ends there.
"""

import math
from typing import NamedTuple

import numpy as np

from vision_core.geometry import Bytes, Floats
from vision_core.models.mirror import MM_PER_M
from vision_core.native.kernels import kernel
from vision_core.protocol.messages import NOTHING_PX
from vision_core.protocol.see import FARTHEST_M
from vision_core.views.outlines import Row

REQUEST = np.dtype(
    [
        ("viewer", np.int32), ("rays", np.int32), ("first", np.int32), ("step", np.int32), ("directions", np.int32),
        ("letters", np.int32), ("clockwise", np.int32), ("half_size", np.int32), ("us", np.int32), ("nul", np.int32),
        ("own_mirror", np.int32), ("fov_deg", np.float64), ("center_deg", np.float64),
        ("a", np.float64), ("b", np.float64), ("c", np.float64), ("d", np.float64),
    ]
)  # fmt: skip
"""What one client asked for. first, step: of its directions, in rays of a grid of so many, anticlockwise; a, b, c, d:
of the mirror, d = a^2 - b^2 c."""

MAX_HEAD = 32
"""Where edges begin in a datagram's slot; its head ends here [bytes]."""
SLOT = 1408
"""From one datagram to the next [bytes]: MAX_HEAD, 3 * MAX_DIRECTIONS and the ball."""
WORDS = SLOT // 4
HEAD = np.frombuffer(b"(see ", dtype=np.uint8)
EDGE = np.frombuffer(b" ((edge) ", dtype=np.uint8)
BALL = np.frombuffer(b") ((ball) ", dtype=np.uint8)


class Ink(NamedTuple):
    """Characters and memory of the writer."""

    hex_words: "np.ndarray[tuple[int], np.dtype[np.uint32]]"
    """A distance's two characters where they stand in an edge, shape (256,)."""
    letters: Bytes
    """EdgeKind to letter for same, team, number, shape (3, 256)."""
    text: Bytes
    """Slots, shape (n * SLOT,)."""
    words: "np.ndarray[tuple[int], np.dtype[np.uint32]]"
    """The same memory, shape (n * WORDS,)."""
    px: Bytes
    """Of one view through a client's own mirror or grid, shape (MAX_RAYS,)."""
    page_px: Bytes
    """Of every viewer through the field's, every whole degree, shape (VIEWERS, 360)."""


@kernel
def mirror_px(distances_m: Floats, a: float, b: float, c: float, d: float, px: Bytes) -> None:
    """int(f^-1(r)) of each distance r (equation 1), 255 for nothing: ``protocol.see.edge_px``. px is filled."""
    for i in range(len(px)):
        far = distances_m[i]
        mm = min(far, FARTHEST_M) * MM_PER_M
        pixels = np.int32(d * mm / (a + b * math.sqrt(c + d * (mm * mm))))
        px[i] = NOTHING_PX if far == math.inf else pixels


@kernel
def ball_words(seen: Row, request: Row) -> tuple[int, int, int]:
    """The ball's distance [px], direction and size [deg] for a client: ``protocol.see.ball_from_view``."""
    if seen.ball_share <= 0.0:
        return -1, 0, 0
    direction = -seen.ball_deg if request.clockwise else seen.ball_deg
    if request.fov_deg < 360.0:
        off_center = abs((direction - request.center_deg + 180.0) % 360.0 - 180.0)
        if off_center > (request.fov_deg + seen.ball_size_deg) / 2.0:
            return -1, 0, 0
    size = seen.ball_size_deg / 2.0 if request.half_size else seen.ball_size_deg
    mm = seen.ball_m * MM_PER_M
    px = int(request.d * mm / (request.a + request.b * math.sqrt(request.c + request.d * (mm * mm))))
    return px, math.floor(direction + 0.5) % 360, max(math.floor(size + 0.5), 1)


@kernel
def write_see(
    time_ns: int, seen: Row, request: Row, rays: int, kinds: Bytes, px: Bytes, slot: int, ink: Ink
) -> tuple[int, int]:
    """Write one datagram into a slot; returns where it begins in ``ink.text`` and how long it is.

    time_ns: grab of the image since the server's start, 0 when it was before; kinds, px: of every ray of the viewer's
    grid, shape (rays,).
    """
    edges = slot * SLOT + MAX_HEAD
    start = _write_head(max(time_ns, 0) // 1000, request.us, edges, ink.text)
    finer = rays // request.rays
    _write_edges(px, kinds, request.first * finer, request.step * finer, rays, request.directions,
                 ink.letters[request.letters], slot * WORDS + MAX_HEAD // 4, ink)  # fmt: skip
    end = _copy(BALL, ink.text, edges + 3 * request.directions)
    distance, direction, size = ball_words(seen, request)
    end = _write_number(distance, ink.text, end)
    end = _write_number(direction, ink.text, end + 1)
    end = _write_number(size, ink.text, end + 1)
    ink.text[end], ink.text[end + 1] = 41, 41
    end += 2
    if request.nul:
        ink.text[end] = 0
        end += 1
    return start, end - start


@kernel
def _write_edges(
    px: Bytes, kinds: Bytes, first: int, step: int, rays: int, directions: int, letters: Bytes, at: int, ink: Ink
) -> None:
    """Type and two hexadecimal digits of every direction, from word `at` on."""
    words, hex_words = ink.words, ink.hex_words
    ray, stride, count, word = np.uint64(first), np.uint64(step), np.uint64(rays), np.uint64(at)
    for _ in range(directions // 4):
        one = hex_words[px[ray]] | letters[kinds[ray]]
        ray = _next(ray, stride, count)
        two = hex_words[px[ray]] | letters[kinds[ray]]
        ray = _next(ray, stride, count)
        three = hex_words[px[ray]] | letters[kinds[ray]]
        ray = _next(ray, stride, count)
        four = hex_words[px[ray]] | letters[kinds[ray]]
        ray = _next(ray, stride, count)
        words[word] = np.uint32(one | two << np.uint32(24))
        words[word + np.uint64(1)] = np.uint32(two >> np.uint32(8) | three << np.uint32(16))
        words[word + np.uint64(2)] = np.uint32(three >> np.uint32(16) | four << np.uint32(8))
        word += np.uint64(3)
    for k in range(directions % 4):
        edge = hex_words[px[ray]] | letters[kinds[ray]]
        for byte in range(3):
            ink.text[4 * int(word) + 3 * k + byte] = edge >> np.uint32(8 * byte) & np.uint32(255)
        ray = _next(ray, stride, count)


@kernel
def _next(ray: np.uint64, stride: np.uint64, count: np.uint64) -> np.uint64:
    ray += stride
    return ray if ray < count else ray - count


@kernel
def _write_head(time_us: int, six: int, edges: int, text: Bytes) -> int:
    """Write ``(see Time ((edge) `` so that it ends at `edges`; returns where it begins."""
    at = edges - len(EDGE)
    _copy(EDGE, text, at)
    seconds, fraction = time_us // 1_000_000, time_us % 1_000_000
    decimals = 6 if six else 3
    if not six:
        fraction //= 1000
    for _ in range(decimals):
        at -= 1
        text[at] = 48 + fraction % 10
        fraction //= 10
    at -= 1
    text[at] = 46
    while True:
        at -= 1
        text[at] = 48 + seconds % 10
        seconds //= 10
        if seconds == 0:
            break
    _copy(HEAD, text, at - len(HEAD))
    return at - len(HEAD)


@kernel
def _write_number(number: int, text: Bytes, at: int) -> int:
    """Write -1 or 0..999, then a space; returns where the space is."""
    if number < 0:
        text[at], number = 45, -number
        at += 1
    if number >= 100:
        text[at] = 48 + number // 100
        at += 1
    if number >= 10:
        text[at] = 48 + number // 10 % 10
        at += 1
    text[at], text[at + 1] = 48 + number % 10, 32
    return at + 1


@kernel
def _copy(source: Bytes, text: Bytes, at: int) -> int:
    """Returns the place after it."""
    for k in range(len(source)):
        text[at + k] = source[k]
    return at + len(source)
