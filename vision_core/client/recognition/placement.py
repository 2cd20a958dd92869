"""Where the mirror is in a team's pictures, as far as the team says it; the rest is found."""

import math
from dataclasses import dataclass

from vision_core.client.recognition.geometry import PictureGeometry, paper_geometry
from vision_core.client.recognition.palette import DRAWN, Palette
from vision_core.client.recognition.rim import find_rim
from vision_core.errors import SettingsError
from vision_core.geometry import Bytes
from vision_core.models.mirror import Mirror

NEAREST_MM = 110.0
"""From here on the paper's robot sees the floor (section 4.3); the rendered one too."""
BALL_RADIUS_MM = 21.35


@dataclass(frozen=True, slots=True)
class Placement:
    """What is known of the pictures; None: to be found, or that of PSLV's own pictures.

    Raises SettingsError for a number that is not accepted.
    """

    center_px: tuple[float, float] | None = None
    """Column and row of the mirror's center; None: the center of its rim."""
    rim_px: float | None = None
    """Radius of the mirror's rim; None: found in the picture."""
    scale: float | None = None
    """Pixels of the picture per pixel of equation 1: 1 for a mirror whose A, B, C were fitted in these pictures. None:
    that of PSLV's pictures of the same size."""
    nearest_mm: float = NEAREST_MM
    ball_radius_mm: float = BALL_RADIUS_MM
    turn_deg: float = 0.0
    mirrored: bool = False

    def __post_init__(self) -> None:
        positive = (("rim", self.rim_px), ("scale", self.scale), ("nearest", self.nearest_mm))
        for name, value in positive:
            if value is not None and not (math.isfinite(value) and value > 0.0):
                raise SettingsError(f"--{name}", found=f"{value:g}", accepted="a number above 0")
        if not (math.isfinite(self.ball_radius_mm) and self.ball_radius_mm >= 0.0):
            raise SettingsError("--ball-radius", found=f"{self.ball_radius_mm:g}", accepted="a number, 0 or more")
        if not all(map(math.isfinite, (self.turn_deg, *(self.center_px or ())))):
            raise SettingsError("--turn, --center", found="a number that is not finite", accepted="finite numbers")

    def geometry(self, picture: Bytes, mirror: Mirror, palette: Palette) -> PictureGeometry:
        """The geometry of a picture, blue green red, shape (height, width, 3).

        Pictures that PSLV has drawn are known: where their mirror is, how near they begin, and that their balls are
        flat. Raises SourceError when the rim is to be found and there is none, and SettingsError when nothing lies
        between the nearest floor and the rim.
        """
        height, width = picture.shape[:2]
        if palette is DRAWN:
            return paper_geometry(mirror, (width, height))
        center, rim = self.center_px, self.rim_px
        if center is None or rim is None:
            found = find_rim(picture)
            center, rim = center or (found.column, found.row), rim or found.radius_px
        geometry = PictureGeometry(
            size_px=(width, height),
            center_px=center,
            rim_px=rim,
            mirror=mirror,
            scale=self.scale or paper_geometry(mirror, (width, height)).scale,
            nearest_mm=self.nearest_mm,
            ball_radius_mm=self.ball_radius_mm,
            turn_deg=self.turn_deg,
            mirrored=self.mirrored,
        )
        if geometry.farthest_px - geometry.nearest_px < 1.0:
            raise SettingsError(
                "the mirror in the picture",
                found=f"the nearest floor at {geometry.nearest_px:.1f} px of equation 1, the rim or the horizon at"
                f" {geometry.farthest_px:.1f}",
                accepted="a --mirror, --scale, --rim and --nearest that leave room between them",
            )
        return geometry
