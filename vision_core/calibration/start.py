"""First guesses of a camera, and what is known about it before any line was looked at.

A lens that was measured with a board holds: the lines then tell the pose, and with it the height.
"""

from dataclasses import dataclass, replace

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
from vision_core.settings.schema import CameraSettings, FieldSettings, LensSettings

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


def start_from_lens(
    lens: Lens, size_px: tuple[int, int], *, height_m: float | None = None, held: LensSettings | None = None
) -> Start:
    """From a camera that is nearly right: a calibrated one that was bumped.

    height_m: by tape measure; held: a lens that was measured with a board. Raises SettingsError for one of another
    picture size.
    """
    if held is not None:
        nearer = held.focal_px / lens.focal_px
        lens = replace(_measured(held, size_px), position_m=lens.position_m * (1.0, 1.0, nearer),
                       camera_from_field=lens.camera_from_field)  # fmt: skip
    height = lens.position_m[2] if height_m is None else height_m
    usual = VENUE_HEIGHT if held is None else GUESSED_HEIGHT
    deviation = usual if height_m is None else MEASURED_HEIGHT
    values = lens.values
    values[HEIGHT] = height
    return Start(lens, _prior(values, size_px, KNOWN_FOCAL * lens.focal_px, deviation * height, held))


def start_from_points(
    pixels: Floats,
    places_m: Floats,
    size_px: tuple[int, int],
    *,
    height_m: float | None = None,
    held: LensSettings | None = None,
) -> Start:
    """From four or more points of the floor: corners that were dragged or found.

    pixels, places_m: shape (n, 2), n >= 4; height_m: of the camera, by tape measure; None: a usual lens is assumed;
    held: a lens that was measured with a board.
    Raises SettingsError for points that no camera over the field sees so, and for a lens of another picture size.
    """
    matrix = homography(places_m, pixels)
    middle = places_m.mean(axis=0)
    seen = mapped(matrix, middle + np.array([[0.0, 0.0], [1e-3, 0.0], [0.0, 1e-3]]))
    ahead, aside = (seen[1] - seen[0]) / 1e-3, (seen[2] - seen[0]) / 1e-3
    area = ahead[0] * aside[1] - ahead[1] * aside[0]
    if not area < 0.0:
        accepted = "each corner in its place: the field's sense of rotation as seen from above"
        raise SettingsError("corners", found="a mirrored field, or two corners exchanged", accepted=accepted)
    scale = float(np.sqrt(-area))
    if held is not None:
        lens = _measured(held, size_px)
    else:
        focal = FOCAL_PER_SIDE * max(size_px) if height_m is None else scale * height_m
        lens = _plain(focal, size_px)
    height = lens.focal_px / scale
    turn = np.arctan2(ahead[1], ahead[0])
    c, s = np.cos(turn), np.sin(turn)
    downwards = np.array([[c, s, 0.0], [s, -c, 0.0], [0.0, 0.0, -1.0]])
    offset = np.array([[c, s], [s, -c]]).T @ ((lens.center_px - seen[0]) / scale)
    lens = replace(lens, position_m=np.array([*(middle + offset), height]), camera_from_field=downwards)
    values = lens.values
    if height_m is not None:
        values[HEIGHT] = height_m
    height_deviation = (GUESSED_HEIGHT if height_m is None else MEASURED_HEIGHT) * height
    focal_deviation = (GUESSED_FOCAL if height_m is None else 0.5) * lens.focal_px
    prior = _prior(values, size_px, focal_deviation, height_deviation, held)
    return Start(fit_points(lens, places_m, pixels, posed(prior, lens)), prior)


def start_from_corners(
    corners_px: Floats,
    field: FieldSettings,
    size_px: tuple[int, int],
    *,
    height_m: float | None = None,
    held: LensSettings | None = None,
) -> Start:
    """From the outer corners of the field's lines that somebody dragged, shape (4, 2), in the order of ``corners_m``.

    Raises SettingsError as ``start_from_points``, and for corners that lie far outside of the picture.
    """
    size = np.array(size_px, dtype=np.float64)
    if not (np.abs(corners_px - size / 2.0) <= 1.5 * size).all():
        found = ", ".join(f"{x:g} {y:g}" for x, y in corners_px.tolist())
        accepted = f"pixels in or near the picture of {size_px[0]}x{size_px[1]}"
        raise SettingsError("corners of the field", found=found, accepted=accepted)
    return start_from_points(corners_px, corners_m(field), size_px, height_m=height_m, held=held)


def start_without_lines(
    field: FieldSettings,
    size_px: tuple[int, int],
    *,
    height_m: float | None = None,
    held: LensSettings | None = None,
) -> Start:
    """A camera over the middle of a field that just fits into its picture. Raises as ``start_from_points``."""
    x, y = field.length_m / 2.0, field.width_m / 2.0
    scale = min(size_px[0] / field.length_m, size_px[1] / field.width_m)
    corners = np.array([[-x, y], [x, y], [x, -y], [-x, -y]])
    pixels = (np.array(size_px) - 1.0) / 2.0 + scale * corners * (1.0, -1.0)
    return start_from_points(pixels, corners, size_px, height_m=height_m, held=held)


def start_from_settings(camera: CameraSettings, *, height_m: float | None = None) -> Start:
    """From the camera of a venue, a pinhole or named points, and its lens, if one was measured with a board.

    Raises SettingsError as ``start_from_points``.
    """
    size, held = (camera.width_px, camera.height_px), camera.lens
    if camera.model == "homography" and camera.homography is not None:
        named = camera.homography.points
        pixels = np.array([point.pixel_px for point in named])
        places = np.array([point.field_m for point in named])
        if held is not None:
            return start_from_points(pixels, places, size, height_m=height_m, held=held)
        start = start_from_points(pixels, places, size, height_m=height_m or camera.homography.position_m[2])
        if height_m is None:
            start.prior.deviations[HEIGHT] = VENUE_HEIGHT * camera.homography.position_m[2]
        return start
    return start_from_lens(Lens.from_settings(camera.pinhole), size, height_m=height_m, held=held)


def with_free_measures(start: Start, field: FieldSettings) -> Start:
    """The same start where the field's measures, except its length, are estimates that are solved too."""
    prior = start.prior
    deviations = prior.deviations.copy()
    deviations[STRETCH] = [max(ESTIMATED * getattr(field, name), FIXED) for name in MEASURES]
    return Start(start.lens, Prior(prior.values, deviations, prior.counts))


def _plain(focal_px: float, size_px: tuple[int, int]) -> Lens:
    """A lens without distortion, its center in the middle of the picture; it has no place yet."""
    center = (np.array(size_px, dtype=np.float64) - 1.0) / 2.0
    return Lens(focal_px, center, np.zeros(4), np.zeros(3), np.eye(3))


def _measured(held: LensSettings, size_px: tuple[int, int]) -> Lens:
    """A lens that was measured with a board; it has no place yet. Raises SettingsError for another picture size."""
    if held.size_px != size_px:
        width, height = held.size_px
        accepted = f"{width}x{height} as the lens was measured with (camera.lens), or the lens measured anew"
        raise SettingsError("the picture", found=f"{size_px[0]}x{size_px[1]} px", accepted=accepted)
    *distortion, k3 = held.distortion
    return Lens(held.focal_px, np.array(held.center_px), np.array(distortion), np.zeros(3), np.eye(3), k3=k3)


def _prior(
    values: Floats, size_px: tuple[int, int], focal_px: float, height_m: float, held: LensSettings | None
) -> Prior:
    """The prior of a lens: how well focal length and height are known, or all of a lens that was measured."""
    deviations, counts, means = np.full(COUNT, FIXED), np.ones(COUNT), values.copy()
    deviations[FOCAL], deviations[CENTER] = focal_px, CENTER_SHARE * max(size_px)
    deviations[DISTORTION] = RADIAL, RADIAL_2, TANGENTIAL, TANGENTIAL
    if held is not None:
        deviations[FOCAL], deviations[CENTER] = held.focal_deviation_px, held.center_deviation_px
        deviations[DISTORTION] = held.distortion_deviation
    deviations[POSITION], deviations[HEIGHT], deviations[TURN] = POSITION_M, height_m, TURN_RAD
    counts[POSITION], counts[HEIGHT], counts[TURN] = 0.0, 1.0, 0.0
    return Prior(means, deviations, counts)
