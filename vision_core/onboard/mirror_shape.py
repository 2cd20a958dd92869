"""The hyperboloidal mirror and the pinhole camera that equation 1 describes, and the reflection of the camera's rays.

Mirror space: origin in the middle between the foci, x forward, y left, z up [m]. The mirror is the upper sheet of
z^2/b^2 - (x^2 + y^2)/a^2 = 1, seen from below. The pinhole is its lower focus, z = -c; the viewpoint is the upper one,
z = c, at the height h over the floor: every reflected ray, extended backwards, passes through the viewpoint.
With b/a = sinh(u/2) and c/a = cosh(u/2) equation 1 follows (``models.mirror``). The mirror's size cancels there; it
decides only how large mirror and camera are.
"""

import math
from dataclasses import dataclass

import numpy as np

from vision_core.geometry import Floats
from vision_core.models.hyperboloid import Hyperboloid
from vision_core.models.mirror import MM_PER_M, Mirror

FOCI_SHARE = 0.3
"""Distance of the foci, as a share of the viewpoint's height: of the paper's mirror 66 mm, which makes it 5 cm wide."""

Ray = tuple[Floats, Floats, Floats, Floats, Floats, Floats]
"""x, y, z of a point and of a direction, each of any shape."""


@dataclass(frozen=True, slots=True)
class MirrorShape:
    """Focal length, height of the viewpoint, and the hyperboloid."""

    f_px: float
    """Focal length of the camera behind the pinhole, in pixels of equation 1."""
    h_m: float
    """Height of the viewpoint over the floor."""
    u: float
    """Of the hyperboloid: b/a = sinh(u/2)."""

    @classmethod
    def from_mirror(cls, mirror: Mirror) -> "MirrorShape":
        """The shape of a mirror of equation 1."""
        form = Hyperboloid.of(mirror)
        return cls(form.focal_px, form.height_mm / MM_PER_M, form.bend)

    @property
    def c_m(self) -> float:
        """Half the distance of the foci [m]."""
        return 0.5 * FOCI_SHARE * self.h_m

    @property
    def a_m(self) -> float:
        """Half axis across [m]."""
        return self.c_m / math.cosh(self.u / 2.0)

    @property
    def b_m(self) -> float:
        """Half axis along [m]."""
        return self.c_m * math.tanh(self.u / 2.0)

    @property
    def pinhole_m(self) -> float:
        """Height of the pinhole over the floor."""
        return self.h_m - 2.0 * self.c_m

    @property
    def asymptote_px(self) -> float:
        """The hyperboloid ends, at infinity, at this radius of the picture [px of equation 1]."""
        return self.f_px / math.sinh(self.u / 2.0)

    def rays_from_px(self, forward_px: Floats, left_px: Floats) -> Ray:
        """The reflected rays of places in the picture [px of equation 1 from its center], nearer than ``asymptote_px``.

        Returns points of the mirror [m] and unit vectors: x, y, z in mirror space.
        """
        return reflect(forward_px, left_px, self.f_px, self.a_m, self.b_m)


def reflect(x: Floats, y: Floats, f: float, a: float, b: float) -> Ray:
    """Where the camera's ray (x, y, f) meets the mirror, and the unit vector of its reflection.

    The ray is -c + t f along z. Of the two sheets the upper one is met at t = a^2 / (c f - b s), s = sqrt(f^2 + R^2).
    The normal N is the gradient of z^2/b^2 - (x^2 + y^2)/a^2; the reflection of d is d - 2 (d N) / (N N) N.
    The only formula of it: ``ray_tracer`` compiles this function.
    """
    c = math.sqrt(a * a + b * b)
    s = np.sqrt(x * x + y * y + f * f)
    t = a * a / (c * f - b * s)
    px, py, pz = t * x, t * y, t * f - c
    nx, ny, nz = -px / (a * a), -py / (a * a), pz / (b * b)
    twice = 2.0 * (x * nx + y * ny + f * nz) / (nx * nx + ny * ny + nz * nz)
    return px, py, pz, (x - twice * nx) / s, (y - twice * ny) / s, (f - twice * nz) / s
