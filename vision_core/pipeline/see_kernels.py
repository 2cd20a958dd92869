"""``see`` datagrams in compiled code: the same bytes as ``protocol.see``, without its objects.

``protocol.see.reference_see`` is the readable reference; a test compares the two for every option.

Each datagram has a slot of fixed size. Edges are written four directions at a time: 4 x 3 characters are three 32-bit
words, little-endian. So the edges begin at a word's boundary, MAX_HEAD bytes into the slot; the head, whose length
varies, is written backwards from there.
"""

import math
from typing import NamedTuple

import numpy as np

from vision_core.clock import NS_PER_US, US_PER_MS, US_PER_S
from vision_core.geometry import Bytes, Floats
from vision_core.models.mirror import MM_PER_M
from vision_core.models.mirror_kernels import px_from_mm
from vision_core.native.kernels import kernel
from vision_core.protocol.messages import NOTHING_PX
from vision_core.protocol.see import MAX_DISTANCE_M
from vision_core.views.outlines import Row

REQUEST = np.dtype(
    [
        ("viewer", np.int32), ("rays", np.int32), ("first", np.int32), ("step", np.int32), ("directions", np.int32),
        ("types", np.int32), ("clockwise", np.int32), ("half_size", np.int32), ("us", np.int32), ("nul", np.int32),
        ("own_mirror", np.int32), ("fov_deg", np.float64), ("center_deg", np.float64),
        ("a", np.float64), ("b", np.float64), ("c", np.float64), ("d", np.float64),
    ]
)  # fmt: skip
"""What one client asked for. viewer: index of its robot; rays: of the coarsest grid that has all its directions;
first, step: its first direction and the distance to the next one, in these rays, anticlockwise; directions: how many;
types: index into TextBuffers.edge_codes; own_mirror: not its team's; a, b, c, d: of its mirror, d = a^2 - b^2 c."""

MAX_HEAD = 32
"""Place of the edges in a slot, and largest length of a datagram's head [bytes]."""
SLOT = 1408
"""Size of a slot [bytes]: MAX_HEAD, 3 * MAX_DIRECTIONS and the ball, rounded up to a multiple of 64."""
WORDS = SLOT // 4
HEAD = np.frombuffer(b"(see ", dtype=np.uint8)
EDGE = np.frombuffer(b" ((edge) ", dtype=np.uint8)
BALL = np.frombuffer(b") ((ball) ", dtype=np.uint8)
SPACE, CLOSE, MINUS, POINT, ZERO, NUL = ord(" "), ord(")"), ord("-"), ord("."), ord("0"), 0
DECIMALS_MS, DECIMALS_US = 3, 6

Words = np.ndarray[tuple[int], np.dtype[np.uint32]]


class TextBuffers(NamedTuple):
    """Lookup tables and memory of the writer."""

    hex_words: Words
    """The two digits of each distance at their place in an edge, shape (256,)."""
    edge_codes: Bytes
    """Letter of each EdgeKind for types same, team, number, shape (3, 256)."""
    text: Bytes
    """The slots, shape (n * SLOT,)."""
    words: Words
    """The same memory, shape (n * WORDS,)."""
    px: Bytes
    """Scratch: pixels of one view through a client's own mirror or grid, shape (MAX_RAYS,)."""
    page_px: Bytes
    """Pixels of every view through the field's mirror, one per whole degree, shape (VIEWERS, 360)."""


@kernel
def view_px(distances_m: Floats, a: float, b: float, c: float, d: float, px: Bytes) -> None:
    """int(f^-1(r)) of each distance r (equation 1), 255 for nothing: ``protocol.see.reference_px``; fills px."""
    for i in range(len(px)):
        far = distances_m[i]
        mm = min(far, MAX_DISTANCE_M) * MM_PER_M
        pixels = np.int32(px_from_mm(mm, a, b, c, d))
        px[i] = NOTHING_PX if far == math.inf else pixels


@kernel
def ball_numbers(viewer: Row, request: Row) -> tuple[int, int, int]:
    """The ball's distance [px], direction and size [deg] for a client: ``protocol.see.reference_ball``.

    viewer: a row of VIEWER; request: a row of REQUEST.
    """
    if viewer.ball_visible <= 0.0:
        return -1, 0, 0
    direction = -viewer.ball_direction_deg if request.clockwise else viewer.ball_direction_deg
    # Hidden when no part of it lies in the client's field of view.
    if request.fov_deg < 360.0:
        off_center = abs((direction - request.center_deg + 180.0) % 360.0 - 180.0)
        if off_center > (request.fov_deg + viewer.ball_size_deg) / 2.0:
            return -1, 0, 0
    size = viewer.ball_size_deg / 2.0 if request.half_size else viewer.ball_size_deg
    px = int(px_from_mm(viewer.ball_m * MM_PER_M, request.a, request.b, request.c, request.d))
    return px, math.floor(direction + 0.5) % 360, max(math.floor(size + 0.5), 1)


@kernel
def write_see(
    time_ns: int, viewer: Row, request: Row, rays: int, kinds: Bytes, px: Bytes, slot: int, buffers: TextBuffers
) -> tuple[int, int]:
    """Write one datagram into a slot; returns where it begins in ``buffers.text`` and how long it is.

    time_ns: grab of the image since the server's start, 0 when it was before; viewer: a row of VIEWER; request: a row
    of REQUEST; kinds, px: of every ray of the viewer's grid, shape (rays,).
    """
    text = buffers.text
    edges = slot * SLOT + MAX_HEAD
    start = _write_head(max(time_ns, 0) // NS_PER_US, request.us, edges, text)
    # The viewer's grid is the finest that any of its clients asked for: this client's rays are every so many-th of it.
    finer = rays // request.rays
    _write_edges(px, kinds, request.first * finer, request.step * finer, rays, request.directions,
                 buffers.edge_codes[request.types], slot * WORDS + MAX_HEAD // 4, buffers)  # fmt: skip
    end = _copy(BALL, text, edges + 3 * request.directions)
    distance, direction, size = ball_numbers(viewer, request)
    end = _write_number(distance, text, end)
    end = _write_number(direction, text, end + 1)
    end = _write_number(size, text, end + 1)
    # Both brackets; the first one replaces the space behind the size.
    text[end], text[end + 1] = CLOSE, CLOSE
    end += 2
    if request.nul:
        text[end] = NUL
        end += 1
    return start, end - start


@kernel
def _write_edges(
    px: Bytes, kinds: Bytes, first: int, step: int, rays: int, directions: int, letters: Bytes, at: int,
    buffers: TextBuffers,
) -> None:  # fmt: skip
    """Write letter and two hexadecimal digits of every direction, from word `at` on."""
    words, hex_words = buffers.words, buffers.hex_words
    # Unsigned indices: numba would test every signed one for counting from the end.
    ray, stride, count, word = np.uint64(first), np.uint64(step), np.uint64(rays), np.uint64(at)
    # Four edges of three bytes (the lower three of a word each) make three words.
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
    # Up to three edges that are left, byte by byte.
    for k in range(directions % 4):
        edge = hex_words[px[ray]] | letters[kinds[ray]]
        for byte in range(3):
            buffers.text[4 * int(word) + 3 * k + byte] = edge >> np.uint32(8 * byte) & np.uint32(255)
        ray = _next(ray, stride, count)


@kernel
def _next(ray: np.uint64, stride: np.uint64, count: np.uint64) -> np.uint64:
    """The ray a stride further, modulo count."""
    ray += stride
    return ray if ray < count else ray - count


@kernel
def _write_head(time_us: int, six: int, edges: int, text: Bytes) -> int:
    """Write ``(see Time ((edge) `` so that it ends at `edges`; returns where it begins. six: decimals, not three."""
    at = edges - len(EDGE)
    _copy(EDGE, text, at)
    # Time, backwards: decimals, point, seconds.
    seconds, fraction = time_us // US_PER_S, time_us % US_PER_S
    decimals = DECIMALS_US if six else DECIMALS_MS
    if not six:
        fraction //= US_PER_MS
    for _ in range(decimals):
        at -= 1
        text[at] = ZERO + fraction % 10
        fraction //= 10
    at -= 1
    text[at] = POINT
    while True:
        at -= 1
        text[at] = ZERO + seconds % 10
        seconds //= 10
        if seconds == 0:
            break
    _copy(HEAD, text, at - len(HEAD))
    return at - len(HEAD)


@kernel
def _write_number(number: int, text: Bytes, at: int) -> int:
    """Write -1 or 0..999, then a space; returns where the space is."""
    if number < 0:
        text[at], number = MINUS, -number
        at += 1
    if number >= 100:
        text[at] = ZERO + number // 100
        at += 1
    if number >= 10:
        text[at] = ZERO + number // 10 % 10
        at += 1
    text[at], text[at + 1] = ZERO + number % 10, SPACE
    return at + 1


@kernel
def _copy(source: Bytes, text: Bytes, at: int) -> int:
    """Copy bytes into the text; returns the place behind them."""
    for k in range(len(source)):
        text[at + k] = source[k]
    return at + len(source)
