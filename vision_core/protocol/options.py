"""What a client may ask for in its ``(init ...)``, each with its rule.

Option names and words are those of the wire. An illegal option opens no session.
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
from vision_core.protocol.error_codes import ErrorName
from vision_core.protocol.s_expressions import Form, integer, real

HIGHEST_VERSION = 1
"""A client that asks for more is answered with this."""
MAX_DATAGRAM = 1400
"""Of the server [bytes]: fits an Ethernet frame with every header in use."""
SEE_FRAME = len("(see 9999999999.999999 ((edge) ) ((ball) 254 359 360))\0")
"""What a ``see`` is long beside its edges, at most."""
MAX_DIRECTIONS = (MAX_DATAGRAM - SEE_FRAME) // 3
TICKS_PER_DEG = 4
"""Directions lie on a grid of a quarter of a degree."""
FASTEST_HZ = 1000
_TYPICAL = 1e9
"""Constants of a mirror beyond this, or below its inverse, are no mirror of this world."""


@dataclass(frozen=True, slots=True)
class Options:
    """How a client wants to see. The defaults are the paper's."""

    version: int = 1
    types: str = "same"
    """same | team | number: how much an edge type tells of a robot."""
    mirror: Mirror | None = None
    """None: the field's."""
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
    """ccw | cw: where directions grow to."""
    port_same: bool = False
    """Views come from the port that init was sent to."""

    @property
    def directions(self) -> int:
        """Number of directions: floor(width / resolution)."""
        return math.floor(self.fov_deg / self.resolution_deg)

    @property
    def first_deg(self) -> float:
        """Direction 0, in the client's sense."""
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

Rule = Callable[[Options, Sequence[str | Form]], Options | None]


def options_from_forms(forms: Sequence[str | Form]) -> tuple[Options, bool] | ErrorName:
    """Options of an init, and whether some were unknown to us; or why they are refused.

    Unknown ones are passed over for clients of a version above ours alone.
    """
    options, unknown, seen = Options(), False, set()
    for form in forms:
        if not isinstance(form, tuple) or not form or not isinstance(form[0], str) or form[0] in seen:
            return ErrorName.ILLEGAL_OPTION
        seen.add(form[0])
        rule = RULES.get(form[0])
        if rule is None:
            unknown = True
            continue
        changed = rule(options, form[1:])
        if changed is None:
            return ErrorName.ILLEGAL_MIRROR if form[0] == "mirror" else ErrorName.ILLEGAL_OPTION
        options = changed
    if (unknown and options.version <= HIGHEST_VERSION) or not _fits(options):
        return ErrorName.ILLEGAL_OPTION
    return options, unknown


def mirror_from_words(words: Sequence[str | Form]) -> Mirror | None:
    """A B C of ``(mirror A B C)``; None when they are no mirror."""
    numbers = [number for word in words if (number := real(word)) is not None]
    if len(numbers) != 3 or len(words) != 3:
        return None
    a, b, c = numbers
    if not (1.0 / _TYPICAL < a < _TYPICAL and 1.0 / _TYPICAL < b < _TYPICAL and 1.0 / _TYPICAL < c < _TYPICAL):
        return None
    try:
        return Mirror(a, b, c)
    except SettingsError:
        return None


@lru_cache(maxsize=64)
def ray_indices(options: Options, rays: int) -> NDArray[np.intp] | None:
    """Which of a view's evenly spaced rays (anticlockwise, ray 0 ahead) the directions are; None: all, in order.

    Raises ValueError when the view has no such rays.
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
    """The first directions in the client's sense, 0 <= d < 360 [deg], shape (count,)."""
    steps = np.arange(count, dtype=np.float64)
    return frozen(np.mod(options.first_deg + options.resolution_deg * steps, 360.0))


def encode_options(options: Options) -> str:
    """The forms of every option that differs from its default."""
    default, words = PAPER_OPTIONS, []
    if options.version != default.version:
        words.append(f"(version {options.version})")
    if options.mirror is not None:
        words.append(f"(mirror {options.mirror.a!r} {options.mirror.b!r} {options.mirror.c!r})")
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
    if options.port_same:
        words.append("(port same)")
    return " ".join(words)


def _ticks(angle_deg: float) -> int:
    return round(angle_deg * TICKS_PER_DEG)


def _on_grid(angle_deg: float) -> bool:
    return (angle_deg * TICKS_PER_DEG).is_integer()


def _fits(options: Options) -> bool:
    on_grid = _on_grid(options.first_deg) and _on_grid(options.resolution_deg)
    return on_grid and 1 <= options.directions <= MAX_DIRECTIONS


def _version(options: Options, words: Sequence[str | Form]) -> Options | None:
    version = integer(words[0]) if len(words) == 1 else None
    return replace(options, version=version) if version is not None and version >= 1 else None


def _rate(options: Options, words: Sequence[str | Form]) -> Options | None:
    rate_hz = integer(words[0]) if len(words) == 1 else None
    return replace(options, rate_hz=rate_hz) if rate_hz is not None and 1 <= rate_hz <= FASTEST_HZ else None


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


def _port(options: Options, words: Sequence[str | Form]) -> Options | None:
    return replace(options, port_same=True) if tuple(words) == ("same",) else None


def _one_of(name: str, *accepted: str) -> Rule:
    def rule(options: Options, words: Sequence[str | Form]) -> Options | None:
        if len(words) != 1 or words[0] not in accepted:
            return None
        return replace(options, **{name: words[0]})  # type: ignore[arg-type]

    return rule


RULES: Mapping[str, Rule] = MappingProxyType(
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
        "port": _port,
    }
)
"""Every option: how its words change the options; None when they are illegal."""
