"""The camera of a new venue: from painted lines, or from the corners of walls where no lines tell enough."""

from collections.abc import Sequence

import msgspec
import numpy as np

from vision_core.calibration.find import corners_m
from vision_core.calibration.result import Calibration, LineResult, Progress
from vision_core.calibration.solve import calibrate, from_other_end
from vision_core.calibration.start import Start, start_from_corners, start_from_points
from vision_core.color.light import field_samples, reference_of
from vision_core.errors import PslvError, SettingsError
from vision_core.geometry import Bytes, Floats
from vision_core.models.camera import CameraModel, PinholeCamera
from vision_core.models.camera_setup import CameraSetup
from vision_core.models.field import accepted_half_extent, field_segments, painted_points
from vision_core.regions.shift_words import calibration_reasons
from vision_core.settings.schema import FieldSettings, HomographySettings, NamedPoint, Settings
from vision_core.setup.draft import Draft, DraftCamera
from vision_core.setup.findings import CameraTrial
from vision_core.setup.floor_colors import floor_colors
from vision_core.setup.jobs import CameraWish
from vision_core.setup.venue_file import settings_of
from vision_core.types.reasons import Reason

NAMES = ("corner left top", "corner right top", "corner right bottom", "corner left bottom")
CARPET_BAND = (0.25, 0.75)
"""Samples of the field that are averaged, from the darkest to the brightest: those of ``colors.light.band``."""
USUAL_ERROR = 0.3
"""A height that follows from a usual lens may be wrong by this share."""
POINTS_PER_LINE = 40
ANY_PATTERN = "ssl-standard"


def find_camera(draft: Draft, pictures: Sequence[Bytes], wish: CameraWish, progress: Progress) -> CameraTrial:
    """Find the camera that sees the draft's field. pictures: shape (height, width, 3) each, of the draft's size.

    Raises SettingsError for a draft without a field, missing corners, and corners that no camera sees so; and what
    progress raises.
    """
    if draft.field is None or not pictures:
        raise SettingsError("the camera", found="no field, or no picture", accepted="both, before it is calibrated")
    if wish.begin == "walls":
        return from_walls(draft, pictures[0], draft.field, wish)
    size = pictures[0].shape[1], pictures[0].shape[0]
    result = calibrate(
        pictures,
        draft.field,
        _start(wish, draft.field, size),
        height_m=wish.height_m,
        frees_measures=wish.frees_measures,
        marker_height_m=draft.robot_height_m,
        progress=progress,
    )
    if wish.swaps_ends:
        result = from_other_end(result)
    return trial_of(result, draft.field, pictures[0], len(pictures), by_hand=wish.begin == "corners")


def trial_of(
    result: Calibration, field: FieldSettings, pixels: Bytes, count: int, *, by_hand: bool = False
) -> CameraTrial:
    """The trial of a calibration by painted lines. pixels: the first picture; count: of pictures."""
    field = msgspec.structs.replace(field, **result.measures_m)
    camera = None
    if result.accepted:
        seen = "one picture" if count == 1 else f"{count} pictures"
        begin = "four corners that somebody dragged" if by_hand else "a search of the whole picture"
        how = (
            f"Calibrated by the painted lines of {seen}, beginning with {begin}: {result.rms_px:.2f} px rms over "
            f"{result.samples} sections, places on the floor up to {1e3 * result.floor_error_m:.1f} mm off"
        )
        height = result.camera.position_m[2]
        how += f"; the height came out as {height:.2f} m +- {result.height_deviation_m:.2f} m."
        lens = result.camera
        model = PinholeCamera(lens.focal_px, lens.center_px, lens.distortion, lens.position_m, lens.rotation_deg)
        reference = _reference(pixels, model, field)
        floor = floor_colors(pixels)
        camera = DraftCamera("pinhole", result.size_px, how, reference, floor, pinhole=result.camera)
    height_m = result.camera.position_m[2]
    return CameraTrial(
        camera, result.measures_m, result.reasons, result.notes, result.lines, height_m, result.is_height_unknown,
        calibration=result,
    )  # fmt: skip


def from_walls(draft: Draft, pixels: Bytes, field: FieldSettings, wish: CameraWish) -> CameraTrial:
    """A camera from the four corners of the field alone, which fit exactly: nothing in the picture checks them.

    pixels: shape (height, width, 3). Raises SettingsError for missing corners, and ones that no camera sees so.
    """
    size = pixels.shape[1], pixels.shape[0]
    if wish.corners_px is None:
        raise SettingsError("corners of the field", found="none", accepted="four, dragged to their places")
    corners = np.array(wish.corners_px[2:] + wish.corners_px[:2] if wish.swaps_ends else wish.corners_px)
    places = _corners_m(field)
    start = start_from_points(corners, places, size, height_m=wish.height_m)
    x_m, y_m, found_m = (round(float(value), 3) for value in start.lens.position_m)
    is_unknown = wish.height_m is None
    height_m = found_m if wish.height_m is None else wish.height_m
    points = tuple(
        NamedPoint(name=name, pixel_px=(x, y), field_m=(u, v))
        for name, (x, y), (u, v) in zip(NAMES, corners.tolist(), places.tolist(), strict=True)
    )
    homography = HomographySettings(points=points, position_m=(x_m, y_m, height_m))
    camera = DraftCamera("homography", size, "", (0.0, 0.0, 0.0), homography=homography)
    try:
        setup = CameraSetup.from_settings(_settings_with(draft, camera))
    except PslvError as error:
        reason = Reason(f"{error.asked.rpartition(': ')[2]}: {error.found}", f"Accepted: {error.accepted}.")
        return CameraTrial(None, {}, (reason,), (), (), height_m, is_unknown, calibration=None)
    notes = _wall_notes(draft, field, setup.model, wish.height_m)
    how = " ".join(["Named points: the four corners of the field, as somebody dragged them.", *notes])
    reference = _reference(pixels, setup.model, field)
    camera = msgspec.structs.replace(camera, how=how, reference_bgr=reference, floor=floor_colors(pixels))
    if field.line_width_m > 0.0:
        notes += tuple(f"{reason.text}." for reason in calibration_reasons(pixels, field, setup))
    return CameraTrial(camera, {}, (), notes, _drawn(field, setup.model), height_m, is_unknown, calibration=None)


def _start(wish: CameraWish, field: FieldSettings, size_px: tuple[int, int]) -> Start | None:
    if wish.begin == "find":
        return None
    if wish.corners_px is None:
        raise SettingsError("corners of the field", found="none", accepted="four, dragged to their places")
    return start_from_corners(np.array(wish.corners_px), field, size_px, height_m=wish.height_m)


def _corners_m(field: FieldSettings) -> Floats:
    """Where the corners are that one drags: the feet of the walls, or of the lines where no walls stand."""
    if not field.walls:
        return corners_m(field)
    x, y = accepted_half_extent(field)
    return np.array([[-x, y], [x, y], [x, -y], [-x, -y]])


def _wall_notes(draft: Draft, field: FieldSettings, model: CameraModel, height_m: float | None) -> tuple[str, ...]:
    """What corners alone do not tell."""
    x, y, height = model.position_m.tolist()
    notes = ["Four corners fit exactly, whatever they are: only the overlay shows whether they are right."]
    if height_m is not None:
        notes.append(f"The height of {height_m:.2f} m was typed.")
        return tuple(notes)
    half_x, half_y = accepted_half_extent(field)
    aside = float(np.hypot(abs(x) + half_x, abs(y) + half_y))
    marker = draft.robot_height_m
    error = aside * marker * (1.0 / (1.0 - USUAL_ERROR) - 1.0) / max(height - marker, 0.1)
    notes.append(
        f"The height of the camera is not known from corners; {height:.2f} m is that of a usual lens, and may be wrong "
        f"by a third: then markers at {marker:g} m are up to {1e3 * error:.0f} mm off. Measure it with a tape."
    )
    return tuple(notes)


def _settings_with(draft: Draft, camera: DraftCamera) -> Settings:
    """The settings with a camera; markers that were not chosen yet are taken to be any. Raises SettingsError."""
    return settings_of(msgspec.structs.replace(draft, camera=camera, pattern=draft.pattern or ANY_PATTERN))


def _drawn(field: FieldSettings, model: CameraModel) -> tuple[LineResult, ...]:
    """Walls and painted lines as paths in the picture."""
    walls = [
        ("wall", np.linspace((one.x1_m, one.y1_m), (one.x2_m, one.y2_m), POINTS_PER_LINE))
        for one in field_segments(field, "left")
        if one.solid
    ]
    painted = [("painted line", points) for points in painted_points(field, POINTS_PER_LINE)]
    return tuple(
        LineResult(
            name=name,
            points_px=tuple((float(x), float(y)) for x, y in model.pixel_from_field(points).tolist()),
            visible=1.0,
            found=0.0,
            rms_px=None,
            beside_px=None,
            held_out_px=None,
            residuals=(),
        )
        for name, points in (*walls, *painted)
    )


def _reference(pixels: Bytes, model: CameraModel, field: FieldSettings) -> tuple[float, float, float]:
    """Mean color of the carpet; black where none of the field lies in the picture."""
    samples = field_samples(model, field, (pixels.shape[1], pixels.shape[0]), 0.0)
    levels, _ = reference_of(pixels, samples, CARPET_BAND)
    blue, green, red = (round(level, 1) if np.isfinite(level) else 0.0 for level in levels)
    return blue, green, red
