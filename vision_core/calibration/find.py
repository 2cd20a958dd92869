"""Finds a field in a picture without a click: hypotheses from pairs of straight lines, judged by all painted lines.

Two lines of one family and two of the other are thought to be four of the field's lines; that gives a homography, and
with it the place of all other lines. The hypothesis under which the painted lines lie nearest to ridges wins.

A field looks the same from both ends. What is found has the field's x axis to the right in the picture, or upward;
which end is which must be said by somebody who knows.
"""

from dataclasses import dataclass
from itertools import combinations

import numpy as np

from vision_core.calibration.painted import painted_sections
from vision_core.calibration.ridges import Ridges, direction_of, find_ridges
from vision_core.calibration.straight import line_families
from vision_core.geometry import Bytes, Floats, Mask
from vision_core.models.field import field_lines
from vision_core.settings.schema import FieldSettings

POINTS_PER_METRE_SHARE = 500.0
"""Model points: sections of a field that is so many pixels long."""
JUDGED_POINTS = 110
CAP_PX = 9.0
MIN_EXTENT, MAX_EXTENT = 0.3, 1.3
"""Size of the field in the picture, as a share of the picture's."""
MAX_RATIO = 1.5
"""Ratio of the scales along and across: a camera over the field looks down on it."""
MAX_TRIED = 60_000
STEP_M = 1e-3


@dataclass(frozen=True, slots=True, eq=False)
class Found:
    """A place of the field in the picture."""

    corners_px: Floats
    """Outer corners of the lines: left top, right top, right bottom, left bottom; shape (4, 2)."""
    error_px: float
    """Mean distance of its lines from ridges, each capped [small px]."""


def corners_m(field: FieldSettings) -> Floats:
    """The outer corners of a field's lines: left top, right top, right bottom, left bottom; shape (4, 2)."""
    x, y = field.length_m / 2.0, field.width_m / 2.0
    return np.array([[-x, y], [x, y], [x, -y], [-x, -y]])


def find_field(pixels: Bytes, field: FieldSettings, count: int = 6) -> list[Found]:
    """The most likely places of a field that is wholly visible, the best first; none where too few lines are seen.

    pixels: shape (height, width, 3), of any orientation.
    """
    ridges = find_ridges(pixels)
    first, second = line_families(ridges)
    along, across = _model_lines(field)
    tried = [_quads(*families, along, across, ridges.mask.shape) for families in ((first, second), (second, first))]
    image, model = (np.concatenate([part[i] for part in tried]) for i in (0, 1))
    if not len(image):
        return []
    matrices = _homographies(model, image)
    matrices = matrices[_is_plausible(matrices, field, ridges.mask.shape)][:MAX_TRIED]
    if not len(matrices):
        return []
    errors = _errors(matrices, field, ridges)
    return _distinct(matrices, errors, field, ridges, count)


def _model_lines(field: FieldSettings) -> tuple[Floats, Floats]:
    """Offsets of the painted lines along the field (their y) and across it (their x), ascending [m]."""
    lines, _ = field_lines(field)
    along = sorted({round(line[1], 6) for line in lines if line[1] == line[3]})
    across = sorted({round(line[0], 6) for line in lines if line[0] == line[2]})
    return np.array(along), np.array(across)


def _quads(
    family: Floats, other: Floats, along: Floats, across: Floats, shape: tuple[int, ...]
) -> tuple[Floats, Floats]:
    """Every way to take two lines of each family for two of the field's along and two across it.

    Returns the four crossings in the picture and on the field, shape (n, 4, 2) each.
    """
    pairs = [
        np.array(list(combinations(range(len(rows)), 2)), dtype=np.intp).reshape(-1, 2) for rows in (family, other)
    ]
    ways = [np.array(list(combinations(rows, 2))).reshape(-1, 2) for rows in (along, across)]
    center = np.array([shape[1] / 2.0, shape[0] / 2.0, 1.0])
    gaps = [
        np.abs((rows[pair] @ center)[:, 0] - (rows[pair] @ center)[:, 1])
        for rows, pair in zip((family, other), pairs, strict=True)
    ]
    scales = [gap[:, None] / (way[:, 1] - way[:, 0]) for gap, way in zip(gaps, ways, strict=True)]
    i, j = (grid.ravel() for grid in np.indices(scales[0].shape))
    k, m = (grid.ravel() for grid in np.indices(scales[1].shape))
    ratio = scales[0].ravel()[:, None] / np.maximum(scales[1].ravel(), 1e-9)
    size = max(shape)
    extent = np.maximum(scales[0].ravel() * (along[-1] - along[0]), 1e-9)
    fits = (ratio < MAX_RATIO) & (ratio > 1.0 / MAX_RATIO)
    fits &= ((extent < MAX_EXTENT * size) & (extent > 0.5 * MIN_EXTENT * min(shape)))[:, None]
    one, two = np.nonzero(fits)
    lines_a, lines_b = family[pairs[0][i[one]]], other[pairs[1][k[two]]]
    places_a, places_b = ways[0][j[one]], ways[1][m[two]]
    image, model = [], []
    for a, b in ((0, 0), (1, 0), (1, 1), (0, 1)):
        crossing = np.cross(lines_a[:, a], lines_b[:, b])
        with np.errstate(divide="ignore", invalid="ignore"):
            image.append(crossing[:, :2] / crossing[:, 2:])
        model.append(np.column_stack([places_b[:, b], places_a[:, a]]))
    points, places = np.stack(image, axis=1), np.stack(model, axis=1)
    if not len(points):
        return points.reshape(0, 4, 2), places.reshape(0, 4, 2)
    mirrored = _turning(points) * _turning(places) > 0.0
    places[mirrored, :, 0] = -places[mirrored, :, 0]
    return points, places


def _turning(quads: Floats) -> Floats:
    """Signed area of four-sided figures, shape (n, 4, 2) -> (n,)."""
    x, y = quads[..., 0], quads[..., 1]
    area: Floats = (x * np.roll(y, -1, axis=1) - y * np.roll(x, -1, axis=1)).sum(axis=1) / 2.0
    return area


def _homographies(source: Floats, target: Floats) -> Floats:
    """Matrices that map four points each to their partners, shape (n, 4, 2) twice -> (n, 3, 3); nan where none does."""
    count = len(source)
    x, y, u, v = source[..., 0], source[..., 1], target[..., 0], target[..., 1]
    zero, one = np.zeros_like(x), np.ones_like(x)
    rows = np.concatenate(
        [
            np.stack([x, y, one, zero, zero, zero, -u * x, -u * y], axis=-1),
            np.stack([zero, zero, zero, x, y, one, -v * x, -v * y], axis=-1),
        ],
        axis=1,
    )
    usable = np.isfinite(rows).all(axis=(1, 2))
    usable[usable] = np.abs(np.linalg.det(rows[usable])) > 1e-12
    result = np.full((count, 9), np.nan)
    result[usable, :8] = np.linalg.solve(rows[usable], np.concatenate([u, v], axis=1)[usable][..., None])[..., 0]
    result[:, 8] = 1.0
    return result.reshape(count, 3, 3)


def _mapped(matrices: Floats, points: Floats) -> Floats:
    """Points, shape (k, 2), by each homography: shape (n, k, 2)."""
    lifted = np.column_stack([points, np.ones(len(points))]) @ np.swapaxes(matrices, 1, 2)
    with np.errstate(divide="ignore", invalid="ignore"):
        mapped: Floats = np.where(lifted[..., 2:] > 0.0, lifted[..., :2] / lifted[..., 2:], np.nan)
    return mapped


def _is_plausible(matrices: Floats, field: FieldSettings, shape: tuple[int, ...]) -> Mask:
    """Which homographies show the field from above, nearly whole, and not too small."""
    corners = _mapped(matrices, corners_m(field))
    size = np.array(shape[::-1])
    with np.errstate(invalid="ignore"):
        inside = ((corners > -0.12 * size) & (corners < 1.12 * size)).all(axis=(1, 2))
        area = np.abs(_turning(corners)) / size.prod()
        sides = np.linalg.norm(corners - np.roll(corners, -1, axis=1), axis=2)
        ratio = np.maximum(sides[:, 0] / sides[:, 2], sides[:, 2] / sides[:, 0])
        ratio = np.maximum(ratio, np.maximum(sides[:, 1] / sides[:, 3], sides[:, 3] / sides[:, 1]))
        shown = (sides[:, 0] / field.length_m) / (sides[:, 1] / field.width_m)
        plausible: Mask = inside & (area > MIN_EXTENT**2) & (ratio < MAX_RATIO)
        plausible &= (shown < MAX_RATIO) & (shown > 1.0 / MAX_RATIO)
    return plausible


def _errors(matrices: Floats, field: FieldSettings, ridges: Ridges) -> Floats:
    """Mean distance of the field's lines from ridges under each homography [small px]."""
    painted = painted_sections(field, POINTS_PER_METRE_SHARE / field.length_m)
    few = np.linspace(0, len(painted) - 1, JUDGED_POINTS).round().astype(np.intp)
    middles, across = painted.middles_m[few], painted.across[few]
    along = np.column_stack([-across[:, 1], across[:, 0]])
    result = []
    height, width = ridges.mask.shape
    for part in np.array_split(matrices, max(len(matrices) // 4000, 1)):
        places = _mapped(part, middles)
        ahead = _mapped(part, middles + along * STEP_M) - places
        kinds = direction_of(np.stack([-ahead[..., 1], ahead[..., 0]], axis=-1))
        with np.errstate(invalid="ignore"):
            x, y = np.rint(places[..., 0]), np.rint(places[..., 1])
            inside = (x >= 0) & (y >= 0) & (x < width) & (y < height)
        x, y = np.where(inside, x, 0).astype(np.intp), np.where(inside, y, 0).astype(np.intp)
        distances = np.where(inside, np.minimum(ridges.distances[kinds, y, x], CAP_PX), CAP_PX)
        result.append(distances.mean(axis=1))
    return np.concatenate(result)


def _distinct(matrices: Floats, errors: Floats, field: FieldSettings, ridges: Ridges, count: int) -> list[Found]:
    """The best homographies that differ, as corners in the whole picture."""
    order = np.argsort(errors)[:2000]
    corners = _mapped(matrices[order], corners_m(field))
    apart = 0.02 * max(ridges.mask.shape)
    kept: list[Found] = []
    shown: list[Floats] = []
    for quad, error in zip(corners, errors[order], strict=True):
        if any(
            min(np.abs(quad - other).max(), np.abs(np.roll(quad, 2, axis=0) - other).max()) < apart for other in shown
        ):
            continue
        shown.append(quad)
        kept.append(Found(_upright((quad + 0.5) / ridges.scale - 0.5), float(error)))
        if len(kept) == count:
            break
    return kept


def _upright(corners: Floats) -> Floats:
    """The same field with its x axis to the right in the picture, or upward when it is portrait."""
    x, y = corners[1] + corners[2] - corners[0] - corners[3]
    is_upright = x > 0.0 if abs(x) >= abs(y) else y < 0.0
    return corners if is_upright else np.roll(corners, 2, axis=0)
