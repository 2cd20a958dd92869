"""Where a picture's mirror is, and what a radius in it means."""

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from vision_core.client.panorama import BODY_MM, HEIGHT_PX, MARGIN_PX, WIDTH_PX
from vision_core.geometry import Floats, frozen
from vision_core.models.hyperboloid import Hyperboloid
from vision_core.models.mirror import Mirror

STEP_PX = 0.5
"""Between two samples of a ray, in pixels of the picture."""
MAX_SAMPLES = 400
"""Of a ray; in larger pictures they lie farther apart."""


@dataclass(frozen=True, slots=True)
class PictureGeometry:
    """How pixels of a picture become directions and radii of equation 1."""

    size_px: tuple[int, int]
    """Width and height."""
    center_px: tuple[float, float]
    """Column and row of the mirror's center."""
    rim_px: float
    """Radius of the mirror's rim [px of the picture]."""
    mirror: Mirror
    scale: float
    """Pixels of the picture per pixel of equation 1."""
    nearest_mm: float = BODY_MM
    """The own body hides the floor up to this distance."""
    ball_radius_mm: float = 0.0
    """The ball's center is so high over the floor; 0: it is drawn where it stands."""
    turn_deg: float = 0.0
    """Where the picture shows the robot's heading, anticlockwise from its upper edge."""
    mirrored: bool = False
    """Left and right are exchanged, as in a picture that nobody has turned round."""

    @property
    def nearest_px(self) -> float:
        """The nearest radius that is searched [px of equation 1]."""
        return self.mirror.px_from_mm(self.nearest_mm)

    @property
    def farthest_px(self) -> float:
        """The farthest radius that is searched, the horizon or the rim [px of equation 1]."""
        return min(self.mirror.horizon_px, self.rim_px / self.scale)

    @property
    def ball_shrink(self) -> float:
        """Distance on the floor of the ball per distance at which its center is seen against the floor."""
        return 1.0 - self.ball_radius_mm / Hyperboloid.of(self.mirror).height_mm

    def pixel_from_px(self, forward_px: Floats, left_px: Floats) -> tuple[Floats, Floats]:
        """Columns and rows of places given in pixels of equation 1."""
        turn = math.radians(self.turn_deg)
        up = math.cos(turn) * forward_px - math.sin(turn) * left_px
        left = math.sin(turn) * forward_px + math.cos(turn) * left_px
        side = 1.0 if self.mirrored else -1.0
        return self.center_px[0] + side * self.scale * left, self.center_px[1] - self.scale * up

    def px_from_pixel(self, column: Floats, row: Floats) -> tuple[Floats, Floats]:
        """Radius [px of equation 1] and direction [deg, 0..360] of places in the picture."""
        side = 1.0 if self.mirrored else -1.0
        left, up = side * (column - self.center_px[0]), self.center_px[1] - row
        direction = np.degrees(np.arctan2(left, up)) - self.turn_deg
        return np.hypot(left, up) / self.scale, direction % 360.0


def paper_geometry(
    mirror: Mirror,
    size_px: tuple[int, int] = (WIDTH_PX, HEIGHT_PX),
    *,
    nearest_mm: float = BODY_MM,
    ball_radius_mm: float = 0.0,
) -> PictureGeometry:
    """The geometry of the pictures that PSLV makes: centered, as large as fits, a horizon beyond the edge scaled down.

    The defaults are those of ``draw_panorama``.
    """
    width, height = size_px
    fits = min(1.0, (HEIGHT_PX / 2.0 - MARGIN_PX) / mirror.horizon_px)
    scale = min(width / WIDTH_PX, height / HEIGHT_PX) * fits
    return PictureGeometry(
        size_px,
        ((width - 1) / 2.0, (height - 1) / 2.0),
        mirror.horizon_px * scale,
        mirror,
        scale,
        nearest_mm,
        ball_radius_mm,
    )


@lru_cache(maxsize=8)
def ray_radii_px(geometry: PictureGeometry) -> Floats:
    """Radii of the samples of every ray [px of equation 1], shape (m,)."""
    first, last = geometry.nearest_px, geometry.farthest_px
    count = min(int((last - first) * geometry.scale / STEP_PX) + 1, MAX_SAMPLES)
    return frozen(np.linspace(first, last, max(count, 2)))
