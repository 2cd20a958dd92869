"""Equation 1 of the PSLV paper: a hyperboloidal mirror over a pinhole camera.

    R = int(f^-1(r)),   r = f(R) = R / (A - B sqrt(C + R^2))

r [mm] is a distance on the floor from the robot's center, R [px] the distance from the image center
of the simulated on-board camera. With focal length f [px], effective viewpoint at height h [mm] and
b/a = sinh(u/2) of the hyperboloid x^2/a^2 - z^2/b^2 = -1:

    C = f^2,   A = f cosh(u) / h,   B = sinh(u) / h,   D = A^2 - B^2 C = C / h^2

The inverse R = D r / (A + B sqrt(C + D r^2)) is stable for every r >= 0 and has no branches; the
textbook quadratic loses all digits near r = 1/B.
"""

import math
from dataclasses import dataclass
from typing import overload

import numpy as np

from vision_core.errors import SettingsError
from vision_core.geometry import Floats

MIN_HORIZON_PX = 20.0
MAX_PX = 254
"""Largest value of two hexadecimal digits but one: ff means nothing within range."""
MIN_SPAN_PX = 3.0
"""Between one metre and the field's diagonal; see ``check_span``."""
MM_PER_M = 1000.0


@dataclass(frozen=True, slots=True)
class Mirror:
    """The constants of equation 1, for distances in millimetres.

    Raises SettingsError naming the violated rule: finite, C > 0, B >= 0, A > B sqrt(C), and the
    horizon sqrt(A^2 / B^2 - C) within 20..254 px.
    """

    a: float
    b: float
    c: float

    def __post_init__(self) -> None:
        found = f"A {self.a:g}, B {self.b:g}, C {self.c:g}"
        if fault := constants_fault(self.a, self.b, self.c):
            raise SettingsError("a mirror of equation 1", found=found, accepted=fault[1])
        horizon = self.horizon_px
        if not MIN_HORIZON_PX <= horizon <= MAX_PX:
            raise SettingsError(
                "a mirror of equation 1",
                found=f"{found}: the horizon at {horizon:.1f} px",
                accepted=f"a horizon of {MIN_HORIZON_PX:.0f}..{MAX_PX} px",
            )

    @property
    def horizon_px(self) -> float:
        """Where the infinitely far floor would be seen [px]; inf when B is 0."""
        if self.b == 0.0:
            return math.inf
        ratio = self.a / self.b  # no power of a or b: a client's may overflow or vanish
        return math.sqrt(max(ratio * ratio - self.c, 0.0))

    @property
    def d(self) -> float:
        """D = A^2 - B^2 C of the inverse."""
        return self.a**2 - self.b**2 * self.c

    @overload
    def px_from_mm(self, r_mm: float) -> float: ...
    @overload
    def px_from_mm(self, r_mm: Floats) -> Floats: ...
    def px_from_mm(self, r_mm: float | Floats) -> float | Floats:
        """f^-1: distance in the mirror's image [px] of a distance on the floor [mm], any r >= 0."""
        px = px_from_mm(r_mm, self.a, self.b, self.c, self.d)
        return px if isinstance(px, np.ndarray) else float(px)

    @overload
    def mm_from_px(self, r_px: float) -> float: ...
    @overload
    def mm_from_px(self, r_px: Floats) -> Floats: ...
    def mm_from_px(self, r_px: float | Floats) -> float | Floats:
        """f: distance on the floor [mm] of a distance in the image [px]; inf from the horizon on."""
        slope = self.a - self.b * np.sqrt(self.c + np.square(r_px))
        with np.errstate(divide="ignore", invalid="ignore"):
            mm: Floats = np.where(slope > 0.0, np.divide(r_px, slope), np.inf)
        return mm if isinstance(r_px, np.ndarray) else float(mm)


def constants_fault(a: float, b: float, c: float) -> tuple[str, str] | None:
    """The constant ("a", "b", "c"; empty: all together) that breaks a rule of equation 1, and the rule; None: all hold,
    but for the horizon's place."""
    rules = (
        *((name, math.isfinite(value), "finite numbers") for name, value in (("a", a), ("b", b), ("c", c))),
        ("c", c > 0.0, "C > 0"),
        ("b", b >= 0.0, "B >= 0"),
        ("", c > 0.0 and a > b * math.sqrt(c), "A > B sqrt(C)"),
    )
    return next(((name, accepted) for name, holds, accepted in rules if not holds), None)


def px_from_mm(
    r_mm: float | Floats, a: float | Floats, b: float | Floats, c: float | Floats, d: float | Floats
) -> float | Floats:
    """f^-1: R [px] of r [mm]; d = a^2 - b^2 c. The only formula of it: ``mirror_kernels`` compiles this function."""
    return d * r_mm / (a + b * np.sqrt(c + d * (r_mm * r_mm)))


PAPER_MIRROR = Mirror(4.0187, 0.0125935, 90000.0)
"""The mirror that the paper's own numbers imply (section 4.3): 4.4 mm/px at 110 mm, 5 mm/px at 220 mm, f = 300 px.
Default of the fields up to 3 m, and of clients, because version 1 of the protocol does not send the field's mirror."""


def check_span(mirror: Mirror, diagonal_m: float) -> None:
    """Raise SettingsError unless the field's diagonal [m] lies at least 3 px beyond one metre."""
    span = mirror.px_from_mm(diagonal_m * MM_PER_M) - mirror.px_from_mm(MM_PER_M)
    if diagonal_m > 1.0 and span < MIN_SPAN_PX:
        raise SettingsError(
            f"a mirror for a field with a diagonal of {diagonal_m:.1f} m",
            found=f"only {span:.1f} px between one metre and the diagonal",
            accepted=f"at least {MIN_SPAN_PX:.0f} px",
        )
