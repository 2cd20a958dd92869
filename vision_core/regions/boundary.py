"""Where the carpet ends in an image: the field's boundary, found by color alone.

After B-Human's column scans (the conventional method in Hasselbring and Baude, "Soccer Field Boundary Detection Using
Convolutional Neural Networks", RoboCup 2021), for a camera on the ceiling: rays go from the field's center outward with
a fixed number of samples each, so that a larger picture takes no longer. The carpet's color is the median of a ring
round the center. Its light is a smooth surface over the field, because lamps and lenses leave corners darker. Along a
ray every sample of carpet adds one and every other sample subtracts one; the boundary is where the sum is highest. So
lines, the ball and robots are bridged where more carpet follows than they hide, and green objects beside the field do
not move the boundary outward.

A shadow is darker and keeps its hue: a color is compared with the carpet's at the same light.
"""

import math

import numpy as np
from numpy.typing import NDArray

from vision_core.geometry import Bytes, Floats, Mask
from vision_core.models.camera import CameraModel
from vision_core.models.field import field_segments
from vision_core.settings.schema import FieldSettings
from vision_core.types.colors import LUMA_BGR
from vision_core.types.edges import EdgeKind
from vision_core.types.field import Segment
from vision_core.types.regions import FieldBoundary

GreyLevels = NDArray[np.float32]

RAYS = 120
SAMPLES = 192
RAY_LENGTH = 1.5
"""Length of the rays, in distances to the wall or limit."""
RING = (0.1, 0.5)
"""Where the carpet's color is learned, in shares of the distance to the wall or limit."""
RING_STEP = 5
"""One of so many samples of the ring is used."""
SURFACE_SHARE, SURFACE_STEP, SURFACE_FITS = 0.9, 8, 6
"""The surface of the light is fitted out to this share of the distance to the wall or limit, to one of so many samples,
and so many times: each time without the outliers of the last fit, which are lines, robots and walls."""
OUTLIER_DEVIATIONS = 2.5
"""Samples farther from the surface than so many median deviations are outliers."""
DARKEST_SHADOW = 0.5
"""Share of the carpet's light that a shadow leaves."""
MAX_BRIGHTER = 0.15
"""Share of its light by which carpet may be brighter than the surface."""
MIN_CHANGE = 5.0
"""Difference of light or color that carpet may have anywhere [grey levels]."""
MIN_HUE_CHANGE = 6.0
"""Difference of color that carpet may have in full light, in proportion less in dimmer light [grey levels]."""
DEVIATIONS = 4.0
"""Beside these, light and color may differ by so many median deviations of the carpet's own."""
MIN_SAMPLES_BEYOND = 2
"""Samples beyond a boundary that must lie in the picture."""
MIN_RAYS = 5
"""Rays with a boundary that a side of the field needs to be judged."""
LUMA = LUMA_BGR.astype(np.float32)


class BoundaryFinder:
    """Finds the boundary of one camera's field. Holds what is the same for all of its images, but no state."""

    def __init__(self, field: FieldSettings, camera: CameraModel, size_px: tuple[int, int]) -> None:
        """size_px: width and height of the images."""
        angles = np.arange(RAYS) * (math.tau / RAYS)
        rays = np.column_stack([np.cos(angles), np.sin(angles)])
        limit_m, hit = _first_hits(rays, field_segments(field, "left"))
        shares = (np.arange(SAMPLES) + 0.5) * (RAY_LENGTH / SAMPLES)
        ends = rays * limit_m[:, None]
        self._size = size_px
        self._pixel: Floats = camera.pixel_from_field((ends[:, None] * shares[:, None]).reshape(-1, 2)).reshape(
            RAYS, SAMPLES, 2
        )
        self._visible = _inside(self._pixel, size_px)
        column, row = np.moveaxis(np.where(self._visible[..., None], self._pixel, 0.0).round().astype(np.intp), -1, 0)
        self._place = row * size_px[0] + column
        self._basis = _surface_basis(rays * limit_m[:, None], np.minimum(shares, 1.0))
        fitted = self._visible & (shares <= SURFACE_SHARE) & (np.arange(SAMPLES) % SURFACE_STEP == 0)
        self._fitted = np.flatnonzero(fitted)
        ring = self._visible & (shares >= RING[0]) & (shares <= RING[1])
        self._ring = np.flatnonzero(ring)[::RING_STEP]
        self._expected_px, self._outward = _limit_in_image(camera, ends, hit)
        line_m = field.line_width_m if field.margin_m < field.line_width_m else 0.0
        self._line_px = line_m * np.sqrt(camera.pixels_per_square_metre(ends))
        walls = np.array([segment.kind == EdgeKind.WALL for segment in hit])
        self._side = _sides(ends)
        self._judged = walls & _inside(self._expected_px, size_px)

    def find(self, pixels: Bytes) -> FieldBoundary:
        """The boundary in an image.

        pixels: shape (height, width, 3), blue green red. Raises ValueError for an image of another size than the
        finder was made for.
        """
        width, height = self._size
        if pixels.shape != (height, width, 3):
            raise ValueError(f"an image of shape {pixels.shape}, not {(height, width, 3)}")
        carpet = self._carpet(pixels.reshape(-1, 3))
        votes = np.where(carpet, 1, -1) * self._visible
        counted = votes.cumsum(axis=1)
        last = counted.argmax(axis=1)
        before = np.arange(SAMPLES) <= last[:, None]
        inside, beyond = (self._visible & before), (self._visible & ~before)
        seen = (counted.max(axis=1) > 0) & (beyond.sum(axis=1) >= MIN_SAMPLES_BEYOND)
        points = self._between(last)
        points[~seen] = np.nan
        confidences = _share(carpet, inside) * _share(~carpet, beyond)
        return self._report(points, np.where(seen, confidences, 0.0), seen)

    def _carpet(self, flat: Bytes) -> Mask:
        """Which samples look like the carpet in the ring, shape (RAYS, SAMPLES). flat: all pixels, shape (n, 3)."""
        if not len(self._ring):
            return np.zeros(self._place.shape, dtype=np.bool_)
        seen = np.take(flat, self._place, axis=0).astype(np.float32)
        light = seen @ LUMA
        color = seen[..., (0, 2)] - light[..., None]
        surface, spread = self._light_surface(light)
        ring_light = max(float(np.median(light.ravel()[self._ring])), 1.0)
        ring_color = np.median(color.reshape(-1, 2)[self._ring], axis=0)
        share = light / np.float32(ring_light)
        difference = color - ring_color * share[..., None]  # from the ring's color at the sample's light
        change = np.hypot(difference[..., 0], difference[..., 1])
        usual = MIN_HUE_CHANGE + DEVIATIONS * float(np.median(change.ravel()[self._ring]))
        margin = MIN_CHANGE + DEVIATIONS * spread
        lit = (light >= DARKEST_SHADOW * surface - margin) & (light <= (1.0 + MAX_BRIGHTER) * surface + margin)
        return np.asarray(lit & (change <= MIN_CHANGE + usual * np.minimum(share, 1.0)))

    def _light_surface(self, light: GreyLevels) -> tuple[GreyLevels, float]:
        """The carpet's light as a smooth surface, shape (RAYS, SAMPLES), and the median deviation from it."""
        basis = self._basis.reshape(-1, self._basis.shape[-1])[self._fitted]
        there = light.ravel()[self._fitted]
        kept = np.ones(len(there), dtype=np.bool_)
        off = np.abs(there - np.median(there))
        for _ in range(SURFACE_FITS):
            used = basis[kept]
            weights = np.linalg.lstsq(used.T @ used, used.T @ there[kept], rcond=None)[0]
            off = np.abs(there - basis @ weights)
            kept = off <= OUTLIER_DEVIATIONS * max(float(np.median(off)), 1.0)
        surface: GreyLevels = np.maximum(self._basis @ weights, np.float32(1.0))
        return surface, float(np.median(off))

    def _between(self, last: NDArray[np.intp]) -> Floats:
        """Middle between the last sample of the field and the next one, per ray, shape (RAYS, 2) [px]."""
        rows = np.arange(RAYS)
        middle: Floats = (self._pixel[rows, last] + self._pixel[rows, np.minimum(last + 1, SAMPLES - 1)]) / 2.0
        return middle

    def _report(self, points: Floats, confidences: Floats, seen: Mask) -> FieldBoundary:
        judged = self._judged & seen
        away = ((points - self._expected_px) * self._outward).sum(axis=1)[judged]
        away -= np.clip(away, -self._line_px[judged], 0.0)  # a line along the wall is neither carpet nor wall
        sides = [away[self._side[judged] == side] for side in range(4)]
        medians = [abs(float(np.median(side))) for side in sides if len(side) >= MIN_RAYS]
        return FieldBoundary(
            points_px=tuple((x, y) for x, y in points.tolist()),
            confidences=tuple(confidences.tolist()),
            found=float(judged.sum() / max(self._judged.sum(), 1)),
            error_px=float(np.median(away)) if medians else None,
            off_px=max(medians, default=None),
        )


def _surface_basis(ends_m: Floats, shares: Floats) -> GreyLevels:
    """Values of the polynomials that make up a smooth surface over the field, at shares of the way to points round it.

    ends_m: shape (n, 2); shares: shape (m,); returns shape (n, m, 7).
    """
    x, y = np.moveaxis(ends_m[:, None] * shares[:, None] / np.abs(ends_m).max(), -1, 0)
    square = x**2 + y**2
    return np.stack([np.ones_like(x), x, y, x**2, x * y, y**2, square**2], axis=-1).astype(np.float32)


def _share(what: Mask, where: Mask) -> Floats:
    """Per row, the share of the true places in ``where`` at which ``what`` is true."""
    share: Floats = (what & where).sum(axis=1) / np.maximum(where.sum(axis=1), 1)
    return share


def _inside(pixel: Floats, size_px: tuple[int, int]) -> Mask:
    with np.errstate(invalid="ignore"):
        return np.asarray(((pixel >= 0.0) & (pixel <= np.array(size_px) - 1.0)).all(axis=-1))


def _first_hits(rays: Floats, segments: tuple[Segment, ...]) -> tuple[Floats, list[Segment]]:
    """Distance from the field's center to the first segment on each ray [m], shape (n,), and that segment.

    rays: unit vectors, shape (n, 2).
    """
    start = np.array([(s.x1_m, s.y1_m) for s in segments])
    along = np.array([(s.x2_m, s.y2_m) for s in segments]) - start
    with np.errstate(divide="ignore", invalid="ignore"):
        slope = _cross(rays[:, None], along)
        reach, place = _cross(start, along) / slope, _cross(start, rays[:, None]) / slope
        met = (reach > 0.0) & (place >= -1e-9) & (place <= 1.0 + 1e-9)
    reach = np.where(met, reach, np.inf)
    nearest = reach.argmin(axis=1)
    return reach[np.arange(len(rays)), nearest], [segments[index] for index in nearest]


def _sides(ends_m: Floats) -> NDArray[np.intp]:
    """Number of the field's side, 0..3, on which each point of its limit lies; shape (n,)."""
    share = ends_m / np.abs(ends_m).max(axis=0)
    upper = np.abs(share[:, 1]) > np.abs(share[:, 0])
    return np.asarray(np.where(upper, 2 + (share[:, 1] > 0.0), share[:, 0] > 0.0), dtype=np.intp)


def _cross(a: Floats, b: Floats) -> Floats:
    product: Floats = a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
    return product


def _limit_in_image(camera: CameraModel, ends: Floats, hit: list[Segment]) -> tuple[Floats, Floats]:
    """Pixels of points on the limit, and the unit normals there, pointing outward; shape (n, 2) each."""
    along = np.array([(s.x2_m - s.x1_m, s.y2_m - s.y1_m) for s in hit])
    step = along * (1e-3 / np.hypot(along[:, 0], along[:, 1]))[:, None]
    here, aside, center = (camera.pixel_from_field(points) for points in (ends, ends + step, np.zeros((1, 2))))
    normal = (aside - here)[:, ::-1] * (1.0, -1.0)
    normal /= np.hypot(normal[:, 0], normal[:, 1])[:, None]
    outward: Floats = normal * np.sign(((here - center) * normal).sum(axis=1))[:, None]
    return here, outward
