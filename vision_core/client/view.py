"""A ``see`` as arrays."""

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from vision_core.client.extras import NO_EXTRAS, Extras, extras_from
from vision_core.client.lag import Lag
from vision_core.geometry import Floats, frozen
from vision_core.models.mirror import MM_PER_M, Mirror
from vision_core.protocol.messages import NOTHING_PX, Ball, See
from vision_core.protocol.options import Options, directions_deg

HALF_PX = 0.5
"""The server rounds distances down to whole pixels; their mean is half a pixel more."""
NO_POSE = "nopose"


@dataclass(frozen=True, slots=True, repr=False)
class View:
    """What the robot sees at one instant. Arrays are read-only and have one element per direction."""

    time_s: float
    """When the image was grabbed, since the server's start."""
    letters: NDArray[np.str_]
    """Type of the nearest edge, one character each, shape (n,). Unknown types are kept."""
    px: NDArray[np.int16]
    """Its distance in the mirror's image [px], -1 for nothing within range, shape (n,)."""
    mm: Floats
    """Its distance on the floor [mm], inf for nothing, shape (n,)."""
    directions_deg: Floats
    """From the robot's heading, in the sense of the options, 0 <= d < 360, shape (n,)."""
    ball: Ball
    ball_mm: float
    """Distance of the ball on the floor [mm], inf when it is hidden."""
    age_s: float = math.nan
    """From the grab of the image until the view was given to the program; nan: the server's clock is not known."""
    age_bound_s: float = math.inf
    """The true age differs by at most so much."""
    extras: Extras = NO_EXTRAS
    """What was asked for with ``Options(extras=...)``, and whether the camera sees the robot at all."""
    lag: Lag | None = None
    """The lags A, B and C; None unless the extra ``age`` was asked for and the server's clock is known."""

    @property
    def seq(self) -> int | None:
        """Number of the camera's image; None unless it was asked for."""
        return self.extras.seq

    @property
    def sent_s(self) -> float | None:
        """When the view was written, in the time of ``time_s``; None unless it was asked for."""
        return self.extras.sent_s

    @property
    def confidence(self) -> float | None:
        """How sure the server is of the robot, 0..1; None unless it was asked for."""
        return self.extras.confidence

    @property
    def flags(self) -> frozenset[str]:
        """overlap, partial, predicted, as far as they were asked for; nopose comes unasked."""
        return self.extras.flags

    @property
    def is_seen(self) -> bool:
        """False in a view without content: the camera has not seen the robot for some time."""
        return NO_POSE not in self.extras.flags

    @property
    def points_m(self) -> Floats:
        """The edges in the robot's frame, x forward and y to the left [m], nan for nothing, shape (n, 2).

        Directions must grow anticlockwise, as they do unless the options say otherwise.
        """
        distances_m = np.where(np.isfinite(self.mm), self.mm, np.nan) / MM_PER_M
        angles = np.radians(self.directions_deg)
        return np.column_stack([distances_m * np.cos(angles), distances_m * np.sin(angles)])

    @property
    def ball_m(self) -> tuple[float, float] | None:
        """The ball in the robot's frame, x forward and y to the left [m]; None while it is hidden."""
        if self.ball.hidden:
            return None
        angle = math.radians(self.ball.direction_deg)
        return self.ball_mm / MM_PER_M * math.cos(angle), self.ball_mm / MM_PER_M * math.sin(angle)

    def __repr__(self) -> str:
        """One line, not hundreds of edges."""
        return f"View({self.time_s:.3f} s, {len(self.px)} edges, {self.summary})"

    @property
    def summary(self) -> str:
        """The nearest edge and the ball, for people."""
        nearest = "nothing near"
        if len(self.mm) and math.isfinite(nearest_mm := self.mm.min()):
            where = int(np.argmin(self.mm))
            letter, direction = self.letters[where], self.directions_deg[where]
            nearest = f"nearest {letter} at {nearest_mm / MM_PER_M:.2f} m, {direction:.0f} deg"
        if self.ball.hidden:
            return f"{nearest}, ball hidden"
        return f"{nearest}, ball at {self.ball_mm / MM_PER_M:.2f} m, {self.ball.direction_deg} deg"


def view_from_see(see: See, options: Options, mirror: Mirror) -> View:
    """The view of a message. options: those of the session; mirror: the one that the server renders it through."""
    characters = np.frombuffer(see.edges, dtype=np.uint8).reshape(-1, 3)
    digits = _digit_values()[characters[:, 1:]]
    px = (digits[:, 0] * 16 + digits[:, 1]).astype(np.int16)
    px[px == NOTHING_PX] = -1
    return View(
        time_s=see.time_s,
        letters=frozen(characters[:, 0].astype(np.uint32).view("U1")),
        px=frozen(px),
        mm=frozen(_distances_mm(mirror)[px]),
        directions_deg=directions_deg(options, len(px)),
        ball=see.ball,
        ball_mm=math.inf if see.ball.hidden else mirror.mm_from_px(see.ball.px + HALF_PX),
        extras=extras_from(see),
    )


@lru_cache(maxsize=1)
def _digit_values() -> NDArray[np.uint8]:
    """Value of each hexadecimal digit by its character, shape (256,)."""
    values = np.zeros(256, dtype=np.uint8)
    for value, digit in enumerate("0123456789abcdef"):
        values[[ord(digit), ord(digit.upper())]] = value
    return values


@lru_cache(maxsize=8)
def _distances_mm(mirror: Mirror) -> Floats:
    """Distance of each pixel 0..254 [mm], and inf as the last element, which index -1 finds; shape (256,)."""
    return frozen(np.append(mirror.mm_from_px(np.arange(NOTHING_PX, dtype=np.float64) + HALF_PX), math.inf))
