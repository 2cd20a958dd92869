"""The options of ``(init ...)`` and ``(set ...)``, and the parser of each.

Option names and words are those of the wire. An init with an illegal option opens no session.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from vision_core.errors import SettingsError
from vision_core.geometry import Floats, frozen
from vision_core.models.mirror import Mirror
from vision_core.protocol.error_codes import ErrorCode
from vision_core.protocol.s_expressions import Form, integer, real

HIGHEST_VERSION = 2
"""The server answers clients of a higher version as if they had asked for this one."""
MAX_DATAGRAM = 1400
"""Longest datagram of the server [bytes]: fits into an Ethernet frame with every header in use."""
SEE_OVERHEAD = len("(see 9999999999.999999 ((edge) ) ((ball) 254 359 360))\0")
"""Greatest length of a ``see`` without its edges [bytes]."""
MAX_DIRECTIONS = (MAX_DATAGRAM - SEE_OVERHEAD) // 3
EXTRAS: Mapping[str, int] = MappingProxyType(
    {
        "seq": len(" ((seq) 9999999999)"),
        "age": len(" ((age) 9999999999)"),
        "sent": len(" ((sent) 9999999999.999999)"),
        "conf": len(" ((conf) 100)"),
        "flags": len(" ((flags) overlap partial predicted)"),
    }
)
"""The greatest length of what each extra appends to a ``see`` [bytes], in the order in which they are appended."""
TICKS_PER_DEG = 4
"""Directions lie on a grid of a quarter of a degree."""
MAX_RATE_HZ = 1000
_MAX_CONSTANT = 1e9
"""A mirror with a constant above this, or below its inverse, is refused."""


@dataclass(frozen=True, slots=True)
class Options:
    """What a client asks for. The defaults are the paper's."""

    version: int = 1
    types: str = "same"
    """same | team | number: whether an edge type names a robot's team and number."""
    mirror: Mirror | None = None
    """None: the mirror of the server's field."""
    fov_deg: float = 360.0
    center_deg: float = 180.0
    resolution_deg: float = 1.0
    rate_hz: int | None = None
    """At most so many ``see`` a second; None: one per camera frame."""
    time: str = "ms"
    """ms: three decimals, us: six."""
    size: str = "full"
    """full | half: the ball's whole azimuth, or half of it."""
    sense: str = "ccw"
    """ccw | cw: directions grow anticlockwise or clockwise."""
    extras: tuple[str, ...] = ()
    """Of EXTRAS, in their order: what follows the ball in each ``see``. From version 2 on."""
    port_same: bool = False
    """Views come from the port that init was sent to."""

    @property
    def directions(self) -> int:
        """Number of directions: floor(field of view / resolution)."""
        return math.floor(self.fov_deg / self.resolution_deg)

    @property
    def first_deg(self) -> float:
        """Direction of edge 0 [deg], in the client's sense."""
        return self.center_deg - self.fov_deg / 2.0

    @property
    def rays_per_circle(self) -> int:
        """How many evenly spaced rays a view must have so that every direction is one of them: 360, 720 or 1440."""
        for rays_per_deg in (1, 2):
            ticks = TICKS_PER_DEG // rays_per_deg
            if not (_ticks(self.first_deg) % ticks or _ticks(self.resolution_deg) % ticks):
                return 360 * rays_per_deg
        return 360 * TICKS_PER_DEG


PAPER_OPTIONS = Options()

OptionParser = Callable[[Options, Sequence[str | Form]], Options | None]


def options_from_forms(forms: Sequence[str | Form], base: Options = PAPER_OPTIONS) -> tuple[Options, bool] | ErrorCode:
    """Options as forms change them, and whether some are unknown; or the error that refuses them.

    base: what holds without the forms. Unknown options are ignored from version 2 on, and refused in version 1.
    """
    options, unknown, seen = base, False, set()
    for form in forms:
        if not isinstance(form, tuple) or not form or not isinstance(form[0], str) or form[0] in seen:
            return ErrorCode.ILLEGAL_OPTION
        seen.add(form[0])
        parser = OPTION_PARSERS.get(form[0])
        if parser is None:
            unknown = True
            continue
        changed = parser(options, form[1:])
        if changed is None:
            return ErrorCode.ILLEGAL_MIRROR if form[0] == "mirror" else ErrorCode.ILLEGAL_OPTION
        options = changed
    of_version_2 = unknown or options.extras
    if (of_version_2 and options.version < 2) or not _fits(options):
        return ErrorCode.ILLEGAL_OPTION
    return options, unknown


def mirror_from_words(words: Sequence[str | Form]) -> Mirror | None:
    """The mirror of the words A B C; None when there is no such mirror."""
    numbers = [number for word in words if (number := real(word)) is not None]
    if len(numbers) != 3 or len(words) != 3:
        return None
    if not all(1.0 / _MAX_CONSTANT < number < _MAX_CONSTANT for number in numbers):
        return None
    try:
        return Mirror(*numbers)
    except SettingsError:
        return None


@lru_cache(maxsize=64)
def ray_indices(options: Options, rays: int) -> NDArray[np.intp] | None:
    """Indices of the rays that the directions are, shape (directions,); None: all rays, in order.

    rays: number of a view's evenly spaced rays, anticlockwise, ray 0 ahead. Raises ValueError when a direction lies
    between two rays.
    """
    if rays % options.rays_per_circle:
        raise ValueError(f"directions every {options.resolution_deg:g} deg from a view of {rays} rays")
    per_tick = rays / (360 * TICKS_PER_DEG)
    first, step = _ticks(options.first_deg) * per_tick, _ticks(options.resolution_deg) * per_tick
    indices: NDArray[np.intp] = np.rint(first + step * np.arange(options.directions)).astype(np.intp) % rays
    if options.sense == "cw":
        indices = -indices % rays
    if np.array_equal(indices, np.arange(rays)):
        return None
    return frozen(indices)


@lru_cache(maxsize=64)
def directions_deg(options: Options, count: int) -> Floats:
    """The first ``count`` directions in the client's sense, 0 <= d < 360 [deg], shape (count,)."""
    steps = np.arange(count, dtype=np.float64)
    return frozen(np.mod(options.first_deg + options.resolution_deg * steps, 360.0))


def encode_mirror(mirror: Mirror) -> str:
    """The words A B C; ``mirror_from_words`` gives exactly the same numbers."""
    return f"{mirror.a!r} {mirror.b!r} {mirror.c!r}"


def encode_options(options: Options) -> str:
    """The forms of every option that differs from its default."""
    default, words = PAPER_OPTIONS, []
    if options.version != default.version:
        words.append(f"(version {options.version})")
    if options.mirror is not None:
        words.append(f"(mirror {encode_mirror(options.mirror)})")
    if (options.fov_deg, options.center_deg) != (default.fov_deg, default.center_deg):
        words.append(f"(fov {options.fov_deg!r} {options.center_deg!r})")
    if options.resolution_deg != default.resolution_deg:
        words.append(f"(resolution {options.resolution_deg!r})")
    if options.rate_hz is not None:
        words.append(f"(rate {options.rate_hz})")
    named = ("types", "time", "size", "sense")
    words += [
        f"({name} {getattr(options, name)})" for name in named if getattr(options, name) != getattr(default, name)
    ]
    if options.extras:
        words.append(f"(extra {' '.join(options.extras)})")
    if options.port_same:
        words.append("(port same)")
    return " ".join(words)


def _ticks(angle_deg: float) -> int:
    return round(angle_deg * TICKS_PER_DEG)


def _on_grid(angle_deg: float) -> bool:
    return (angle_deg * TICKS_PER_DEG).is_integer()


def _fits(options: Options) -> bool:
    """Do the directions lie on the grid of rays, and do they and the extras fit into a datagram?"""
    on_grid = _on_grid(options.first_deg) and _on_grid(options.resolution_deg)
    length = SEE_OVERHEAD + 3 * options.directions + sum(EXTRAS[name] for name in options.extras)
    return on_grid and options.directions >= 1 and length <= MAX_DATAGRAM


def _version(options: Options, words: Sequence[str | Form]) -> Options | None:
    version = integer(words[0]) if len(words) == 1 else None
    return replace(options, version=version) if version is not None and version >= 1 else None


def _rate(options: Options, words: Sequence[str | Form]) -> Options | None:
    rate_hz = integer(words[0]) if len(words) == 1 else None
    return replace(options, rate_hz=rate_hz) if rate_hz is not None and 1 <= rate_hz <= MAX_RATE_HZ else None


def _mirror(options: Options, words: Sequence[str | Form]) -> Options | None:
    mirror = mirror_from_words(words)
    return replace(options, mirror=mirror) if mirror is not None else None


def _fov(options: Options, words: Sequence[str | Form]) -> Options | None:
    angles = [real(word) for word in words]
    if not 1 <= len(angles) <= 2 or angles[0] is None or not 0.0 < angles[0] <= 360.0:
        return None
    ahead = 180.0 if angles[0] == 360.0 else 0.0
    center = angles[1] if len(angles) == 2 else ahead
    if center is None or not -360.0 <= center <= 360.0:
        return None
    return replace(options, fov_deg=angles[0], center_deg=center)


def _resolution(options: Options, words: Sequence[str | Form]) -> Options | None:
    step = real(words[0]) if len(words) == 1 else None
    return replace(options, resolution_deg=step) if step is not None and 0.0 < step <= 360.0 else None


def _extra(options: Options, words: Sequence[str | Form]) -> Options | None:
    asked = set(words)
    if not words or len(asked) != len(words) or not asked <= EXTRAS.keys():
        return None
    return replace(options, extras=tuple(name for name in EXTRAS if name in asked))


def _port(options: Options, words: Sequence[str | Form]) -> Options | None:
    return replace(options, port_same=True) if tuple(words) == ("same",) else None


def _one_of(name: str, *accepted: str) -> OptionParser:
    def parser(options: Options, words: Sequence[str | Form]) -> Options | None:
        if len(words) != 1 or words[0] not in accepted:
            return None
        return replace(options, **{name: words[0]})  # type: ignore[arg-type]

    return parser


OPTION_PARSERS: Mapping[str, OptionParser] = MappingProxyType(
    {
        "version": _version,
        "types": _one_of("types", "same", "team", "number"),
        "mirror": _mirror,
        "fov": _fov,
        "resolution": _resolution,
        "rate": _rate,
        "time": _one_of("time", "ms", "us"),
        "size": _one_of("size", "full", "half"),
        "sense": _one_of("sense", "ccw", "cw"),
        "extra": _extra,
        "port": _port,
    }
)
"""The parser of each option: gives the options changed by its words, or None when the words are illegal."""
