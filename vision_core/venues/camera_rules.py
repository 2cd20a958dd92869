"""Rules for the geometry of a camera: refuse what no camera over a field can be.

A wrong calibration moves every robot; an impossible one makes image areas infinite or negative, and everything that is
computed from them. These rules refuse the impossible ones, in words: points that coincide, lie on one line or far off
the field; two points exchanged, a mirrored field, millimetres for metres; a camera that does not look at the field.
Space and units as in ``vision_core.models.camera``.
"""

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from vision_core.errors import SettingsError
from vision_core.geometry import Floats
from vision_core.models.camera import CameraModel, homography, mapped
from vision_core.models.camera_setup import CameraSetup
from vision_core.models.field import accepted_half_extent
from vision_core.settings.schema import HomographySettings, NamedPoint, Settings
from vision_core.venues.violation import Violation

POINTS = "camera.homography.points"
MIN_APART_PX, MIN_APART_M = 2.0, 0.01
"""Two named points nearer than this cannot be told apart."""
MIN_SPREAD = 0.02
"""Points count as lying on one line when they spread less than this across it, as a share of their spread along it."""
MAX_FIELD_DISTANCE_M = 1.0
"""Named points may lie so far outside the walls or limits; on a large field, as far as its half size."""
MIN_RESIDUAL_PX, MAX_RESIDUAL = 4.0, 0.01
"""Five or more points may miss their fit by four pixels, or by this share of the picture's width: lenses bend lines."""
MAX_HEIGHT_M = 100.0
MAX_ASIDE = 5.0
"""Horizontal distance of a camera from the field's edge, as a multiple of its height: it looks at most 79 deg aside."""
MIN_VISIBLE = {"homography": 0.1, "pinhole": 0.01}
"""Share of the field that a camera must see: named points hold for what they span; a lens may be a test rig's."""
MIN_ROBOT_PX = 4.0
"""Width of a robot in the picture: from here on down no marker can be read."""
MAX_ANISOTROPY = 5.0
"""Ratio of the image's scales along and across: a camera 78 deg from the vertical."""
MAX_ROUND_TRIP_M = 0.01
"""Field -> image -> field must lead back; a distortion that folds the image does not."""
HEIGHT_ERROR = 0.1
"""Relative error of a height for which the error of robots' places is said."""
GRID_SIDE = 41
STEP_M = 1e-3


def camera_violations(settings: Settings) -> Iterator[Violation]:
    """Everything that is impossible about the camera; what depends on a broken rule is not checked."""
    key = f"camera.{settings.camera.model}"
    points = settings.camera.homography
    if settings.camera.model == "homography" and points is None:
        yield Violation(key, "nothing", "four named points, as camera.model says homography")
        return
    found = False
    for violation in _point_violations(settings, points) if points is not None else ():
        found = True
        yield violation
    if found:
        return
    try:
        camera = CameraSetup.from_settings(settings).model
    except SettingsError as error:
        yield Violation(key, error.found, error.accepted)
        return
    yield from _position(settings, camera, key)
    yield from _view(settings, camera, key)


@dataclass(frozen=True, slots=True)
class FitResidual:
    """How well a homography fits the points that it was made from."""

    rms_px: float
    worst_px: float
    worst: str
    """Name of the point that the fit misses by worst_px."""


def fit_residual(points: Sequence[NamedPoint]) -> FitResidual:
    """The distances [px] between named points and where the homography through all of them puts them.

    Four points are always fitted exactly. With six or more the worst point is the one without which the others fit
    best, which names the wrong one more surely than the largest distance. Raises SettingsError as ``homography``.
    """
    distances = _residuals(points)
    worst = int(np.argmax(distances))
    if len(points) > 5:
        rest = [_residuals([*points[:i], *points[i + 1 :]]).max() for i in range(len(points))]
        worst = int(np.argmin(rest)) if distances.max() > MIN_RESIDUAL_PX else worst
    return FitResidual(float(np.sqrt((distances**2).mean())), float(distances[worst]), points[worst].name)


def fit_in_words(settings: Settings) -> str:
    """How well a camera from named points fits them, " from 5 points, ...", and what an error of its height would do.

    Empty for a calibrated lens.
    """
    fitted = settings.camera.homography
    if settings.camera.model != "homography" or fitted is None:
        return ""
    height = _height_in_words(settings, fitted)
    if len(fitted.points) == 4:
        return f" from four points (which fit exactly: further points would show an error); {height}"
    residual = fit_residual(fitted.points)
    rms, worst = f"{residual.rms_px:.1f} px rms", f"{residual.worst_px:.1f} px at {residual.worst!r}"
    return f" from {len(fitted.points)} points, residual {rms}, worst {worst}; {height}"


def _height_in_words(settings: Settings, fitted: HomographySettings) -> str:
    """How far robots would be misplaced if the camera's height, by tape, were wrong: no picture shows small errors."""
    x, y, height_m = fitted.position_m
    half_x, half_y = accepted_half_extent(settings.field)
    farthest_m = float(np.hypot(abs(x) + half_x, abs(y) + half_y))
    off_m = farthest_m * settings.robots.height_m / height_m * HEIGHT_ERROR / (1.0 - HEIGHT_ERROR)
    return f"{HEIGHT_ERROR:.0%} of its height of {height_m:g} m would move robots by up to {1e3 * off_m:.0f} mm"


def _residuals(points: Sequence[NamedPoint]) -> Floats:
    pixels, places = _pixels(points), _places(points)
    distances: Floats = np.hypot(*(mapped(homography(places, pixels), places) - pixels).T)
    return distances


def _point_violations(settings: Settings, homography_settings: HomographySettings) -> Iterator[Violation]:
    """The first rule of named points that does not hold."""
    for rule in (_points_in_picture, _points_near_field, _points_apart, _points_spread, _points_in_order, _points_fit):
        try:
            violations = list(rule(settings, homography_settings.points))
        except SettingsError as error:  # points of which no homography can be made
            violations = [Violation(POINTS, error.found, error.accepted)]
        yield from violations
        if violations:
            return


def _points_in_picture(settings: Settings, points: Sequence[NamedPoint]) -> Iterator[Violation]:
    """A corner may lie a little outside of the picture; one far away is a slip of the finger."""
    width, height = settings.camera.width_px, settings.camera.height_px
    for point in points:
        x, y = point.pixel_px
        if not (-width / 2 <= x <= 1.5 * width and -height / 2 <= y <= 1.5 * height):
            found = f"{point.name!r} at ({x:g}, {y:g}) px"
            yield Violation(POINTS, found, f"points in or near the picture of {width}x{height}")


def _points_near_field(settings: Settings, points: Sequence[NamedPoint]) -> Iterator[Violation]:
    half_x, half_y = accepted_half_extent(settings.field)
    limit_x, limit_y = (half + max(half, MAX_FIELD_DISTANCE_M) for half in (half_x, half_y))
    for point in points:
        x, y = point.field_m
        if abs(x) <= limit_x and abs(y) <= limit_y:
            continue
        is_mm = abs(x) <= 1e3 * limit_x and abs(y) <= 1e3 * limit_y and max(abs(x), abs(y)) >= 100.0
        found = f"{point.name!r} at ({x:g}, {y:g}) m{': millimetres?' if is_mm else ''}"
        where = f"points on or near the field {settings.field.name!r}, in metres"
        yield Violation(POINTS, found, f"{where}: x within +-{limit_x:.3g}, y within +-{limit_y:.3g}")


def _points_apart(_settings: Settings, points: Sequence[NamedPoint]) -> Iterator[Violation]:
    for one, other in itertools.combinations(points, 2):
        (x, y), (u, v) = one.pixel_px, other.pixel_px
        if np.hypot(x - u, y - v) < MIN_APART_PX:
            found = f"{one.name!r} and {other.name!r} coincide at pixel ({u:g}, {v:g})"
            yield Violation(POINTS, found, "points that differ in the picture")
        (x, y), (u, v) = one.field_m, other.field_m
        if np.hypot(x - u, y - v) < MIN_APART_M:
            found = f"{one.name!r} and {other.name!r} coincide at ({u:g}, {v:g}) m"
            yield Violation(POINTS, found, "points that differ on the field")


def _points_spread(_settings: Settings, points: Sequence[NamedPoint]) -> Iterator[Violation]:
    """Four points must not have three on one line; of more points, not all but one may lie on one line."""
    accepted = "four or more points that span the field, no three of four on one line"
    for kind, places in (("pixel_px", _pixels(points)), ("field_m", _places(points))):
        for left_out in range(len(points)):
            rest = np.delete(places, left_out, axis=0)
            along, across = np.linalg.svd(rest - rest.mean(axis=0), compute_uv=False)
            if across < MIN_SPREAD * along:
                names = ", ".join(repr(point.name) for point in np.delete(np.array(points, dtype=object), left_out))
                yield Violation(POINTS, f"{names} lie on one line (by their {kind})", accepted)
                return


def _points_in_order(settings: Settings, points: Sequence[NamedPoint]) -> Iterator[Violation]:
    """A camera over the floor keeps the sense of rotation, and every point lies in front of it."""
    pixels, places = _pixels(points), _places(points)
    if _seen_from_above(pixels, places):
        return
    accepted = "each point's own pixel_px and field_m; field x to the right, y up when seen from above"
    for i, j in itertools.combinations(range(len(points)), 2):
        exchanged = pixels.copy()
        exchanged[[i, j]] = pixels[[j, i]]
        if _seen_from_above(exchanged, places) and not _seen_from_above(pixels * (-1.0, 1.0), places):
            found = f"the points' lines cross: {points[i].name!r} and {points[j].name!r} seem to be exchanged"
            yield Violation(POINTS, found, accepted)
            return
    if not _seen_from_above(pixels * (-1.0, 1.0), places):
        yield Violation(POINTS, "points whose lines cross: no camera sees them so", accepted)
        return
    reason = "left and right, top and bottom, or two opposite corners exchanged"
    half = np.array(accepted_half_extent(settings.field))
    size = np.array([settings.camera.width_px, settings.camera.height_px])
    if (np.abs(places) > half + MIN_APART_M).any() and (np.abs(places[:, ::-1]) <= half + MIN_APART_M).all():
        reason = "x and y of field_m exchanged"
    elif (pixels >= size).any() and (pixels[:, ::-1] < size).all():
        reason = "x and y of pixel_px exchanged"
    yield Violation(POINTS, f"a mirrored field: {reason}?", accepted)


def _points_fit(settings: Settings, points: Sequence[NamedPoint]) -> Iterator[Violation]:
    residual = fit_residual(points)
    limit_px = max(MIN_RESIDUAL_PX, MAX_RESIDUAL * settings.camera.width_px)
    if max(residual.worst_px, residual.rms_px) > limit_px:
        found = f"the fit of {len(points)} points misses {residual.worst!r} by {residual.worst_px:.0f} px"
        yield Violation(POINTS, found, f"points that one camera can see so, within {limit_px:.3g} px")


def _position(settings: Settings, camera: CameraModel, key: str) -> Iterator[Violation]:
    x, y, height_m = camera.position_m.tolist()
    lowest_m = settings.robots.height_m
    if not lowest_m < height_m <= MAX_HEIGHT_M:
        accepted = f"a camera higher than the robots' markers ({lowest_m:g} m) and at most {MAX_HEIGHT_M:g} m high"
        yield Violation(f"{key}.position_m", f"{height_m:g} m high", accepted)
        return
    half_x, half_y = accepted_half_extent(settings.field)
    aside_m = float(np.hypot(max(abs(x) - half_x, 0.0), max(abs(y) - half_y, 0.0)))
    if aside_m > MAX_ASIDE * height_m:
        found = f"({x:g}, {y:g}) m, {aside_m:.3g} m beside the field and {height_m:g} m high"
        accepted = f"a camera at most {MAX_ASIDE:g} times as far beside the field as it is high"
        yield Violation(f"{key}.position_m", found, accepted)


def _view(settings: Settings, camera: CameraModel, key: str) -> Iterator[Violation]:
    """What of the field lies in the picture, and at which scale."""
    half_x, half_y = accepted_half_extent(settings.field)
    steps = np.linspace(-1.0, 1.0, GRID_SIDE)
    along, across = np.meshgrid(steps * half_x, steps * half_y)
    grid = np.column_stack([along.ravel(), across.ravel()])
    size = CameraSetup.from_settings(settings).size_px
    with np.errstate(all="ignore"):  # points that the camera cannot see
        pixels = camera.pixel_from_field(grid)
        visible = ((pixels >= 0.0) & (pixels <= np.array(size) - 1.0)).all(axis=1)
        aside = (camera.pixel_from_field(grid + np.array([STEP_M, 0.0])) - pixels) / STEP_M
        ahead = (camera.pixel_from_field(grid + np.array([0.0, STEP_M])) - pixels) / STEP_M
        back = camera.field_from_pixel(pixels)
    least = MIN_VISIBLE[settings.camera.model]
    if visible.mean() < least:
        found = f"a camera that sees {visible.mean():.0%} of the field {settings.field.name!r}"
        accepted = f"a pose and field of which at least {least:.0%} lies in the picture of {size[0]}x{size[1]}"
        yield Violation(key, found, accepted)
        return
    off_m = float(np.hypot(*(back - grid)[visible].T).max())
    if not off_m <= MAX_ROUND_TRIP_M:
        found = f"a distortion that folds the picture: from the field to a pixel and back is {off_m:.2g} m off"
        yield Violation(key, found, f"at most {MAX_ROUND_TRIP_M:g} m")
        return
    scales = np.linalg.svd(np.stack([aside, ahead], axis=-1)[visible], compute_uv=False)
    robot_px = 2.0 * settings.robots.radius_m * float(np.median(np.sqrt(scales.prod(axis=1))))
    if not MIN_ROBOT_PX <= robot_px <= size[0]:
        found = f"robots that would be {robot_px:.2g} px wide"
        yield Violation(
            key, found, f"{MIN_ROBOT_PX:g} to {size[0]} px (field_m, position_m and radius_m are in metres)"
        )
        return
    if (ratio := float(np.median(scales[:, 0] / scales[:, 1]))) > MAX_ANISOTROPY:
        found = f"{ratio:.1f} times as many pixels per metre in one direction as across it"
        yield Violation(key, found, f"at most {MAX_ANISOTROPY:g} times: a camera that looks down on the field")


def _seen_from_above(pixels: Floats, places: Floats) -> bool:
    """Does the homography keep every point in front of the camera, and the sense of rotation of a view from above?

    In the picture y points down, so the Jacobian of (field -> image) is negative everywhere that the camera sees.
    """
    matrix = homography(places, pixels)
    depths = np.column_stack([places, np.ones(len(places))]) @ matrix[2]
    return bool((np.linalg.det(matrix) * depths < 0.0).all())


def _pixels(points: Sequence[NamedPoint]) -> Floats:
    return np.array([point.pixel_px for point in points], dtype=np.float64)


def _places(points: Sequence[NamedPoint]) -> Floats:
    return np.array([point.field_m for point in points], dtype=np.float64)
