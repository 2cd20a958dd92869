"""First guesses of a camera, and what is known about it before any line was looked at."""

from dataclasses import dataclass

import numpy as np

from vision_core.calibration.align import fit_points, posed
from vision_core.calibration.find import corners_m
from vision_core.calibration.lens import (
    CENTER,
    COUNT,
    DISTORTION,
    FOCAL,
    HEIGHT,
    MEASURES,
    POSITION,
    STRETCH,
    TURN,
    Lens,
)
from vision_core.calibration.solver import Prior
from vision_core.errors import SettingsError
from vision_core.geometry import Floats
from vision_core.models.camera import homography, mapped
from vision_core.settings.schema import CameraSettings, FieldSettings

FOCAL_PER_SIDE = 0.9
"""Of a camera about which nothing is known: focal length over the picture's longer side, a view of 58 degrees."""
GUESSED_FOCAL, KNOWN_FOCAL = 0.3, 0.05
"""Relative deviations of a focal length that was guessed, and of one from a calibrated lens."""
GUESSED_HEIGHT, VENUE_HEIGHT, MEASURED_HEIGHT = 0.5, 0.05, 0.01
"""Relative deviations of a height that was guessed, of one in a venue's file, and of one by tape measure."""
CENTER_SHARE = 0.02
"""Deviation of the principal point, as a share of the picture's longer side."""
RADIAL, RADIAL_2, TANGENTIAL = 0.15, 0.1, 7e-4
FIXED, ESTIMATED = 1e-9, 0.03
"""Deviations of measures of the field that are known [m], and relative ones of those that are estimates."""
POSITION_M, TURN_RAD = 0.1, 0.02
"""Scales of steps, no priors: lines say where the camera is and looks."""


@dataclass(frozen=True, slots=True, eq=False)
class Start:
    """A camera to begin with."""

    lens: Lens
    prior: Prior


def start_from_lens(lens: Lens, size_px: tuple[int, int], *, height_m: float | None = None) -> Start:
    """From a camera that is nearly right: a calibrated one that was bumped. height_m: by tape measure."""
    height = lens.position_m[2] if height_m is None else height_m
    values = lens.values
    values[HEIGHT] = height
    height_deviation = VENUE_HEIGHT if height_m is None else MEASURED_HEIGHT
    return Start(lens, _prior(values, size_px, KNOWN_FOCAL * lens.focal_px, height_deviation * height))


def start_from_points(
    pixels: Floats, places_m: Floats, size_px: tuple[int, int], *, height_m: float | None = None
) -> Start:
    """From four or more points of the floor: corners that were dragged or found.

    pixels, places_m: shape (n, 2), n >= 4; height_m: of the camera, by tape measure; None: a usual lens is assumed.
    Raises SettingsError for points that no camera over the field sees so.
    """
    matrix = homography(places_m, pixels)
    middle = places_m.mean(axis=0)
    seen = mapped(matrix, middle + np.array([[0.0, 0.0], [1e-3, 0.0], [0.0, 1e-3]]))
    ahead, aside = (seen[1] - seen[0]) / 1e-3, (seen[2] - seen[0]) / 1e-3
    area = ahead[0] * aside[1] - ahead[1] * aside[0]
    if not area < 0.0:
        accepted = "each corner in its place: the field's sense of rotation as seen from above"
        raise SettingsError("corners", found="a mirrored field, or two corners exchanged", accepted=accepted)
    scale, side = float(np.sqrt(-area)), max(size_px)
    focal = FOCAL_PER_SIDE * side if height_m is None else scale * height_m
    height = focal / scale
    turn = np.arctan2(ahead[1], ahead[0])
    c, s = np.cos(turn), np.sin(turn)
    downwards = np.array([[c, s, 0.0], [s, -c, 0.0], [0.0, 0.0, -1.0]])
    center = (np.array(size_px, dtype=np.float64) - 1.0) / 2.0
    offset = np.array([[c, s], [s, -c]]).T @ ((center - seen[0]) / scale)
    lens = Lens(focal, center, np.zeros(4), np.array([*(middle + offset), height]), downwards)
    height_deviation = (GUESSED_HEIGHT if height_m is None else MEASURED_HEIGHT) * height
    focal_deviation = GUESSED_FOCAL * focal if height_m is None else 0.5 * focal
    prior = _prior(lens.values, size_px, focal_deviation, height_deviation)
    return Start(fit_points(lens, places_m, pixels, posed(prior, lens)), prior)


def start_from_corners(
    corners_px: Floats, field: FieldSettings, size_px: tuple[int, int], *, height_m: float | None = None
) -> Start:
    """From the outer corners of the field's lines that somebody dragged, shape (4, 2), in the order of ``corners_m``.

    Raises SettingsError as ``start_from_points``, and for corners that lie far outside of the picture.
    """
    size = np.array(size_px, dtype=np.float64)
    if not (np.abs(corners_px - size / 2.0) <= 1.5 * size).all():
        found = ", ".join(f"{x:g} {y:g}" for x, y in corners_px.tolist())
        accepted = f"pixels in or near the picture of {size_px[0]}x{size_px[1]}"
        raise SettingsError("corners of the field", found=found, accepted=accepted)
    return start_from_points(corners_px, corners_m(field), size_px, height_m=height_m)


def start_without_lines(field: FieldSettings, size_px: tuple[int, int], *, height_m: float | None = None) -> Start:
    """A camera over the middle of a field that just fits into its picture."""
    x, y = field.length_m / 2.0, field.width_m / 2.0
    scale = min(size_px[0] / field.length_m, size_px[1] / field.width_m)
    corners = np.array([[-x, y], [x, y], [x, -y], [-x, -y]])
    pixels = (np.array(size_px) - 1.0) / 2.0 + scale * corners * (1.0, -1.0)
    return start_from_points(pixels, corners, size_px, height_m=height_m)


def start_from_settings(camera: CameraSettings, *, height_m: float | None = None) -> Start:
    """From the camera of a venue, a pinhole or named points. Raises SettingsError as ``start_from_points``."""
    size = camera.width_px, camera.height_px
    if camera.model == "homography" and camera.homography is not None:
        named = camera.homography.points
        pixels = np.array([point.pixel_px for point in named])
        places = np.array([point.field_m for point in named])
        start = start_from_points(pixels, places, size, height_m=height_m or camera.homography.position_m[2])
        if height_m is None:
            start.prior.deviations[HEIGHT] = VENUE_HEIGHT * camera.homography.position_m[2]
        return start
    return start_from_lens(Lens.from_settings(camera.pinhole), size, height_m=height_m)


def with_free_measures(start: Start, field: FieldSettings) -> Start:
    """The same start where the field's measures, except its length, are estimates that are solved too."""
    prior = start.prior
    deviations = prior.deviations.copy()
    deviations[STRETCH] = [max(ESTIMATED * getattr(field, name), FIXED) for name in MEASURES]
    return Start(start.lens, Prior(prior.values, deviations, prior.counts))


def _prior(values: Floats, size_px: tuple[int, int], focal_px: float, height_m: float) -> Prior:
    """The prior of a lens about which focal length and height are known so well."""
    deviations, counts, means = np.full(COUNT, FIXED), np.ones(COUNT), values.copy()
    deviations[FOCAL], deviations[CENTER] = focal_px, CENTER_SHARE * max(size_px)
    deviations[DISTORTION] = RADIAL, RADIAL_2, TANGENTIAL, TANGENTIAL
    deviations[POSITION], deviations[HEIGHT], deviations[TURN] = POSITION_M, height_m, TURN_RAD
    counts[POSITION], counts[HEIGHT], counts[TURN] = 0.0, 1.0, 0.0
    return Prior(means, deviations, counts)
