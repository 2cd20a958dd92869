"""What a mirror of equation 1 is made of: focal length, height and bend, one-to-one with A, B, C.

A hyperboloid x^2/a^2 - z^2/b^2 = -1 over a pinhole of focal length f [px] in its lower focus; the upper one, the
effective viewpoint, is h [mm] over the floor, and b/a = sinh(u/2). The mirror's size cancels. Then

    C = f^2,   A = f cosh(u) / h,   B = sinh(u) / h

With R small against f the three constants are almost collinear; f, h and u are what can be measured by other means.
"""

import math
from dataclasses import dataclass

from vision_core.models.mirror import Mirror


@dataclass(frozen=True, slots=True)
class Hyperboloid:
    """A hyperboloidal mirror over a pinhole, all three more than 0."""

    focal_px: float
    """f of the camera."""
    height_mm: float
    """h: the effective viewpoint over the floor."""
    bend: float
    """u; b/a = sinh(u/2)."""

    @classmethod
    def of(cls, mirror: Mirror) -> "Hyperboloid":
        """The shape of a mirror of equation 1. B must be more than 0: no mirror with a horizon has another."""
        focal = math.sqrt(mirror.c)
        height = focal / math.sqrt(mirror.d)
        return cls(focal, height, math.asinh(mirror.b * height))

    @property
    def constants(self) -> tuple[float, float, float]:
        """A, B, C of equation 1, which need not be a mirror that is allowed."""
        focal, height = self.focal_px, self.height_mm
        return focal * math.cosh(self.bend) / height, math.sinh(self.bend) / height, focal * focal

    def mirror(self) -> Mirror:
        """As equation 1 says it. Raises SettingsError that names the rule it violates."""
        return Mirror(*self.constants)
