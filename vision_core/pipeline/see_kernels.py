"""``see`` datagrams in compiled code: the same bytes as ``protocol.see``, without its objects.

``protocol.see.reference_see`` is the readable reference; a test compares the two for every option.

Each datagram has a slot of fixed size. Edges are written four directions at a time: 4 x 3 characters are three 32-bit
words, little-endian. So the edges begin at a word's boundary, MAX_HEAD bytes into the slot; the head, whose length
varies, is written backwards from there.
"""

import math
from typing import NamedTuple

import numpy as np

from vision_core.clock import US_PER_MS, US_PER_S
from vision_core.geometry import Bytes, Floats
from vision_core.models.mirror import MM_PER_M
from vision_core.models.mirror_kernels import px_from_mm
from vision_core.native.kernels import kernel
from vision_core.protocol.messages import NOTHING_PX
from vision_core.protocol.options import EXTRAS
from vision_core.protocol.see import MAX_DISTANCE_M
from vision_core.views.outlines import Row

REQUEST = np.dtype(
    [
        ("viewer", np.int32), ("rays", np.int32), ("first", np.int32), ("step", np.int32), ("directions", np.int32),
        ("types", np.int32), ("clockwise", np.int32), ("half_size", np.int32), ("us", np.int32), ("nul", np.int32),
        ("own_mirror", np.int32), ("extras", np.int32), ("blind", np.int32),
        ("fov_deg", np.float64), ("center_deg", np.float64),
        ("a", np.float64), ("b", np.float64), ("c", np.float64), ("d", np.float64),
    ]
)  # fmt: skip
"""What one client asked for. viewer: index of its robot; rays: of the coarsest grid that has all its directions;
first, step: its first direction and the distance to the next one, in these rays, anticlockwise; directions: how many;
types: index into TextBuffers.edge_codes; own_mirror: not its team's; extras: the bits of EXTRA_BITS; blind: it is told
when its robot is not seen; a, b, c, d: of its mirror, d = a^2 - b^2 c."""
EXTRA_BITS = {name: 1 << place for place, name in enumerate(EXTRAS)}

MAX_HEAD = 32
"""Place of the edges in a slot, and largest length of a datagram's head [bytes]."""
SLOT = 1472
"""Size of a slot [bytes]: the longest datagram, and what a short head leaves of MAX_HEAD; a multiple of 64."""
WORDS = SLOT // 4
HEAD = np.frombuffer(b"(see ", dtype=np.uint8)
EDGE = np.frombuffer(b" ((edge) ", dtype=np.uint8)
BALL = np.frombuffer(b") ((ball) ", dtype=np.uint8)
SEQ, AGE, SENT, CONF, FLAGS = (EXTRA_BITS[name] for name in EXTRAS)
SEQ_HEAD, AGE_HEAD, SENT_HEAD, CONF_HEAD, FLAGS_HEAD = (
    np.frombuffer(f" (({name})".encode("ascii"), dtype=np.uint8) for name in EXTRAS
)
OVERLAP, PARTIAL, PREDICTED, NOPOSE = (
    np.frombuffer(f" {flag}".encode("ascii"), dtype=np.uint8) for flag in ("overlap", "partial", "predicted", "nopose")
)
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


class Moment(NamedTuple):
    """The frame that a datagram is about, and when it is written."""

    frame: int
    """Number of the camera's image."""
    grabbed_us: int
    """Time of the image [us since the server's start]."""
    written_us: int
    """Time of the writing."""


class Track(NamedTuple):
    """How well the viewer's own robot is known."""

    percent: int
    """Confidence of its track."""
    predicted: bool
    """The camera did not see it in this image."""


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
    moment: Moment, viewer: Row, track: Track, request: Row, rays: int, kinds: Bytes, px: Bytes, slot: int,
    buffers: TextBuffers,
) -> tuple[int, int]:  # fmt: skip
    """Write one datagram into a slot; returns where it begins in ``buffers.text`` and how long it is.

    viewer: a row of VIEWER, robot -1 when it is not seen; request: a row of REQUEST; kinds, px: of every ray of the
    viewer's grid, shape (rays,).
    """
    text = buffers.text
    edges = slot * SLOT + MAX_HEAD
    start = _write_head(moment.grabbed_us, request.us, edges, text)
    # The viewer's grid is the finest that any of its clients asked for: this client's rays are every so many-th of it.
    finer = rays // request.rays
    _write_edges(px, kinds, request.first * finer, request.step * finer, rays, request.directions,
                 buffers.edge_codes[request.types], slot * WORDS + MAX_HEAD // 4, buffers)  # fmt: skip
    end = _copy(BALL, text, edges + 3 * request.directions)
    distance, direction, size = ball_numbers(viewer, request)
    end = _write_number(distance, text, end)
    end = _write_number(direction, text, end + 1)
    end = _write_number(size, text, end + 1)
    text[end] = CLOSE  # in place of the space behind the size
    is_partial = distance >= 0 and viewer.ball_visible < 1.0
    end = _write_extras(moment, viewer, track, request, is_partial, text, end + 1)
    text[end] = CLOSE
    end += 1
    if request.nul:
        text[end] = NUL
        end += 1
    return start, end - start


@kernel
def _write_extras(
    moment: Moment, viewer: Row, track: Track, request: Row, is_partial: bool, text: Bytes, at: int
) -> int:
    """Write what the client asked for beyond the paper's message; returns the place behind it.

    is_partial: a part of the ball that the client is told of is hidden.
    """
    extras = request.extras
    if extras & SEQ:
        at = _close(text, _write_long(moment.frame, text, _open(SEQ_HEAD, text, at)))
    if extras & AGE:
        at = _close(text, _write_long(moment.written_us - moment.grabbed_us, text, _open(AGE_HEAD, text, at)))
    if extras & SENT:
        at = _write_long(moment.written_us // US_PER_S, text, _open(SENT_HEAD, text, at))
        text[at] = POINT
        at = _close(text, _write_decimals(moment.written_us % US_PER_S, DECIMALS_US, text, at + 1))
    if extras & CONF:
        at = _close(text, _write_long(track.percent, text, _open(CONF_HEAD, text, at)))
    if extras & FLAGS or viewer.robot < 0:
        at = _copy(FLAGS_HEAD, text, at)
        if viewer.robot < 0:
            at = _copy(NOPOSE, text, at)
        else:
            at = _copy(OVERLAP, text, at) if viewer.overlap else at
            at = _copy(PARTIAL, text, at) if is_partial else at
            at = _copy(PREDICTED, text, at) if track.predicted else at
        at = _close(text, at)
    return at


@kernel
def _open(head: Bytes, text: Bytes, at: int) -> int:
    """Write the head of an extra and a space; returns the place behind it."""
    at = _copy(head, text, at)
    text[at] = SPACE
    return at + 1


@kernel
def _close(text: Bytes, at: int) -> int:
    """Write the bracket that ends an extra; returns the place behind it."""
    text[at] = CLOSE
    return at + 1


@kernel
def _write_long(number: int, text: Bytes, at: int) -> int:
    """Write an integer, 0 if it is negative; returns the place behind it."""
    number = max(number, 0)
    digits, rest = 1, number
    while rest >= 10:
        rest //= 10
        digits += 1
    return _write_decimals(number, digits, text, at)


@kernel
def _write_decimals(number: int, digits: int, text: Bytes, at: int) -> int:
    """Write so many digits of a number; returns the place behind them."""
    for place in range(digits - 1, -1, -1):
        text[at + place] = ZERO + number % 10
        number //= 10
    return at + digits


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
    at -= decimals
    _write_decimals(fraction, decimals, text, at)
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
