"""The camera of a new venue: from lines, from corners alone, refused with reasons; presets that are recognized."""

import re

import msgspec
import numpy as np
import pytest

from bench.calibration_views import floor_error_m, view
from tests.setup.demo import demo_pictures
from vision_core.calibration.find import corners_m
from vision_core.errors import SettingsError
from vision_core.models.camera_setup import CameraSetup
from vision_core.setup.camera import find_camera
from vision_core.setup.choices import with_pattern, with_preset
from vision_core.setup.draft import Draft, DraftPicture
from vision_core.setup.findings import painted_share, taken
from vision_core.setup.jobs import CameraWish, Corners
from vision_core.setup.recognize import recognize_field
from vision_core.setup.venue_file import settings_of
from vision_core.venues.presets import shipped_fields

pytestmark = pytest.mark.slow


def no_progress(_what: str, _share: float) -> None:
    """Nobody looks."""


def draft_of(width: int, height: int, preset: str = "ssl-2002") -> Draft:
    picture = DraftPicture(file="1.png", name="1.png", width_px=width, height_px=height)
    return with_pattern(with_preset(Draft(pictures=(picture,)), preset), "ssl-standard")


def corners_of(points: np.ndarray) -> Corners:
    one, two, three, four = ((float(x), float(y)) for x, y in points)
    return one, two, three, four


def test_lines_give_a_lens_and_the_venue_its_settings() -> None:
    shown = view(0)
    height, width, _ = shown.pixels.shape
    draft = draft_of(width, height)
    wish = CameraWish("find", height_m=float(shown.truth.position_m[2]))
    trial = find_camera(draft, [shown.pixels], wish, no_progress)
    assert trial.camera is not None, trial.reasons
    assert trial.camera.pinhole is not None
    assert floor_error_m(trial.camera.pinhole, shown.truth, shown.settings.field) < 0.003
    assert "beginning with a search of the whole picture" in trial.camera.how
    assert min(trial.camera.reference_bgr) > 10.0
    assert painted_share(trial.lines) > 0.8
    assert not trial.is_height_unknown
    settings = settings_of(taken(draft, trial))
    assert settings.camera.pinhole == trial.camera.pinhole


def test_corners_alone_give_named_points_and_say_what_is_not_known() -> None:
    picture = demo_pictures()[0]
    field = msgspec.structs.replace(picture.settings.field, line_width_m=0.0)
    draft = msgspec.structs.replace(draft_of(640, 480), field=field)
    model = CameraSetup.from_settings(picture.settings).model
    corners = corners_of(model.pixel_from_field(corners_m(field)))
    refused = find_camera(draft, [picture.pixels], CameraWish("find"), no_progress)
    assert refused.camera is None
    assert "has no painted lines" in str(refused.reasons[0])
    trial = find_camera(draft, [picture.pixels], CameraWish("walls", corners), no_progress)
    assert trial.camera is not None, trial.reasons
    assert trial.camera.homography is not None
    assert any("only the overlay shows" in note for note in trial.notes)
    assert any("height of the camera is not known" in note for note in trial.notes)
    assert trial.is_height_unknown
    typed = find_camera(draft, [picture.pixels], CameraWish("walls", corners, height_m=3.75), no_progress)
    assert typed.height_m == 3.75
    assert not typed.is_height_unknown
    assert typed.camera is not None
    assert typed.camera.homography is not None
    assert typed.camera.homography.position_m[2] == 3.75
    assert "The height of 3.75 m was typed." in typed.notes
    other = find_camera(draft, [picture.pixels], CameraWish("walls", corners, swaps_ends=True), no_progress)
    assert other.camera is not None
    assert other.camera.homography is not None
    names = {point.name: point.pixel_px for point in other.camera.homography.points}
    assert names["corner left top"] == pytest.approx(corners[2])


def test_a_corner_that_was_dragged_beside_its_place_is_told_where_the_lines_are() -> None:
    picture = demo_pictures()[0]
    settings = picture.settings
    pixels = CameraSetup.from_settings(settings).model.pixel_from_field(corners_m(settings.field))
    pixels[0] += 15.0, 0.0
    trial = find_camera(draft_of(640, 480), [picture.pixels], CameraWish("walls", corners_of(pixels)), no_progress)
    (note,) = (note for note in trial.notes if "corner left top" in note)
    assert "to the right of where the lines say" in note
    assert re.search(r"; by the lines 'corner left top' is at \(\d+, \d+\) px\.$", note), "no command: it is this step"


def test_corners_that_no_camera_sees_are_refused() -> None:
    pixels = demo_pictures()[0].pixels
    draft = draft_of(640, 480)
    with pytest.raises(SettingsError, match="corners of the field; found: none"):
        find_camera(draft, [pixels], CameraWish("walls"), no_progress)
    crossed: Corners = (500.0, 50.0), (50.0, 50.0), (500.0, 400.0), (50.0, 400.0)
    trial = find_camera(draft, [pixels], CameraWish("walls", crossed), no_progress)
    assert trial.camera is None
    assert "the points' lines cross" in str(trial.reasons[0])
    one: Corners = (9.0, 9.0), (9.0, 9.0), (9.0, 9.0), (9.0, 9.0)
    with pytest.raises(SettingsError, match="lie on one line"):
        find_camera(draft, [pixels], CameraWish("walls", one), no_progress)
    tiny: Corners = (300.0, 200.0), (304.0, 200.0), (304.0, 203.0), (300.0, 203.0)
    trial = find_camera(draft, [pixels], CameraWish("walls", tiny), no_progress)
    assert trial.camera is None
    assert str(trial.reasons[0]).startswith("camera.homography.position_m: 398.403 m high. Accepted: a camera higher")
    with pytest.raises(SettingsError, match="at most 100 m high"):
        taken(draft, trial)
    with pytest.raises(SettingsError, match="no field, or no picture"):
        find_camera(Draft(), [pixels], CameraWish("find"), no_progress)


def test_the_field_of_the_demo_is_recognized_first() -> None:
    told: list[float] = []
    pictures = [picture.pixels for picture in demo_pictures(2)]
    fields = {name: shipped_fields()[name] for name in ("ssl-division-b", "ssl-2002", "vsss")}
    fields["no-lines"] = msgspec.structs.replace(fields["vsss"], line_width_m=0.0)
    trials = recognize_field(
        pictures, fields, marker_height_m=0.14, height_m=3.75, progress=lambda _what, share: told.append(share)
    )
    assert trials[0].preset == "ssl-2002"
    assert [trial.camera.camera is not None for trial in trials] == [True, False, False]
    assert trials[0].painted > 0.8 > trials[1].painted
    assert told == sorted(told)
    assert told[-1] == 1.0
