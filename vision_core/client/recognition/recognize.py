"""From a picture to what a ``see`` says."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vision_core.client.recognition.ball import ball_pixels, find_ball
from vision_core.client.recognition.edges import find_edges
from vision_core.client.recognition.geometry import PictureGeometry
from vision_core.client.recognition.palette import RENDERED, Palette, Surface, label_pixels
from vision_core.client.recognition.polar import rays_of, touching
from vision_core.client.recognition.small_ball import find_small_ball
from vision_core.client.view import HALF_PX, View
from vision_core.errors import SourceError
from vision_core.geometry import Bytes, Floats, frozen
from vision_core.models.mirror import MAX_PX, Mirror
from vision_core.protocol.messages import Ball

MIN_FLOOR_SHARE = 0.005
"""With less floor, of all samples, the picture is no on-board picture, or the palette is not the right one."""
WHAT = "an on-board picture"
RIGHT = "see whether palette, center and mirror are those of the picture"


@dataclass(frozen=True, slots=True)
class Recognized:
    """What a picture shows, in the words of a ``see``. Arrays are read-only, one element per direction."""

    letters: NDArray[np.str_]
    """Type of the nearest edge as ``(types team)`` names it; r: a robot without a visible team; shape (n,)."""
    radii_px: Floats
    """Where it begins in the mirror's image [px of equation 1], inf for nothing, shape (n,)."""
    px: NDArray[np.int16]
    """The same as equation 1 tells it: cut to an integer, -1 for nothing, shape (n,)."""
    ball: Ball

    def view(self, mirror: Mirror, time_s: float = 0.0) -> View:
        """The same as a client's view of the server, so that one program can use either eye."""
        seen = np.isfinite(self.radii_px)
        mm = mirror.mm_from_px(np.where(seen, self.radii_px, 0.0))
        return View(
            time_s=time_s,
            letters=self.letters,
            px=self.px,
            mm=frozen(np.where(seen, mm, np.inf)),
            directions_deg=frozen(np.arange(len(self.px), dtype=np.float64) * (360.0 / len(self.px))),
            ball=self.ball,
            ball_mm=math.inf if self.ball.hidden else mirror.mm_from_px(self.ball.px + HALF_PX),
        )


def recognize(
    picture: Bytes, geometry: PictureGeometry, palette: Palette = RENDERED, *, directions: int = 360
) -> Recognized:
    """The nearest edge in evenly spaced directions, anticlockwise from the robot's heading, and the ball.

    picture: blue green red, shape (height, width, 3). Raises SourceError when it has another shape or size than the
    geometry, or shows no floor, or no edge in any direction.
    """
    width, height = geometry.size_px
    if picture.dtype != np.uint8 or picture.shape != (height, width, 3):
        raise SourceError(
            WHAT,
            found=f"{picture.dtype} of shape {picture.shape}",
            accepted=f"uint8 of shape ({height}, {width}, 3), blue green red",
        )
    rays = rays_of(picture, geometry, directions)
    labels, pixels = label_pixels(rays, palette), label_pixels(picture, palette)
    is_ball = ball_pixels(pixels)
    labels[touching(is_ball, geometry, directions) & (labels != Surface.FLOOR)] = Surface.BALL
    if (labels == Surface.FLOOR).mean() < MIN_FLOOR_SHARE:
        raise SourceError(WHAT, found="no floor around the robot", accepted=f"floor: {RIGHT}")
    letters, radii = find_edges(rays, labels, geometry, palette)
    if not np.isfinite(radii).any():
        raise SourceError(WHAT, found="floor, and no edge in any direction", accepted=f"at least one edge: {RIGHT}")
    beyond = not palette.dark_feet  # PSLV draws it behind limits of paint, too
    ball = find_ball(pixels == Surface.BALL, is_ball, radii, geometry, beyond=beyond)
    if ball.hidden and palette.dark_feet:
        ball = find_small_ball(picture, letters, radii, geometry, palette)
    px = np.where(np.isfinite(radii), np.minimum(np.nan_to_num(radii, posinf=-1.0), MAX_PX), -1.0)
    return Recognized(frozen(letters), frozen(radii), frozen(px.astype(np.int16)), ball)
