"""Whole calibrations of rendered pictures: how wrong they are, what is refused, and what a caller can do meanwhile."""

import numpy as np
import pytest
from msgspec.structs import replace

from bench.calibration_views import View, floor_error_m, view
from vision_core.calibration.find import corners_m
from vision_core.calibration.result import Calibration, Cancelled
from vision_core.calibration.solve import calibrate
from vision_core.calibration.start import start_from_lens, start_from_points
from vision_core.errors import SettingsError
from vision_core.geometry import Bytes
from vision_core.settings.schema import LensSettings
from vision_core.venues.loader import load_settings

pytestmark = pytest.mark.slow
SEEDS = range(6)
MAX_ERROR_M = 0.003


@pytest.fixture(scope="module")
def views() -> list[View]:
    return [view(seed) for seed in SEEDS]


def from_start(shown: View, *pictures: Bytes) -> Calibration:
    size = shown.pixels.shape[1], shown.pixels.shape[0]
    return calibrate(pictures or [shown.pixels], shown.settings.field, start_from_lens(shown.start, size))


def test_from_a_camera_that_was_bumped(views: list[View]) -> None:
    for shown in views:
        result = from_start(shown)
        assert result.accepted, result.reasons
        assert floor_error_m(result.camera, shown.truth, shown.settings.field) < MAX_ERROR_M
        assert result.rms_px < 0.5
        assert result.coverage > 0.5


def test_without_a_click(views: list[View]) -> None:
    for shown in views:
        result = calibrate([shown.pixels], shown.settings.field, None)
        assert result.accepted, result.reasons
        assert floor_error_m(result.camera, shown.truth, shown.settings.field) < MAX_ERROR_M
        assert any("from both ends" in note for note in result.notes)


@pytest.mark.parametrize("quarters", [1, 2, 3])
def test_rotated_and_portrait_pictures(views: list[View], quarters: int) -> None:
    shown = views[0]
    result = calibrate([np.ascontiguousarray(np.rot90(shown.pixels, quarters))], shown.settings.field, None)
    assert result.accepted, result.reasons
    assert result.size_px == ((580, 780) if quarters % 2 else (780, 580))
    assert result.camera.position_m[2] == pytest.approx(4.0, rel=0.3)


def test_from_corners_that_were_dragged(views: list[View]) -> None:
    shown = views[1]
    corners = corners_m(shown.settings.field)
    dragged = shown.truth.pixel_from_field(corners) + np.array([[9, -7], [-8, -8], [6, 9], [-9, 5]])
    start = start_from_points(dragged, corners, (780, 580), height_m=float(shown.truth.position_m[2]))
    result = calibrate([shown.pixels], shown.settings.field, start)
    assert result.accepted, result.reasons
    assert floor_error_m(result.camera, shown.truth, shown.settings.field) < MAX_ERROR_M
    assert result.camera.position_m[2] == pytest.approx(shown.truth.position_m[2], rel=0.02)


def test_what_covers_a_line_in_one_picture_is_seen_in_another(views: list[View]) -> None:
    shown = views[2]
    left, right = shown.pixels.copy(), shown.pixels.copy()
    left[:, :480], right[:, 300:] = 90, 90
    assert not from_start(shown, left).accepted
    both = from_start(shown, left, right)
    assert both.accepted, both.reasons
    assert both.samples > 150
    assert floor_error_m(both.camera, shown.truth, shown.settings.field) < MAX_ERROR_M


def test_every_line_is_told(views: list[View]) -> None:
    result = from_start(views[3])
    assert len(result.lines) == 12
    halfway = next(line for line in result.lines if line.name == "halfway line")
    assert halfway.rms_px is not None
    assert halfway.held_out_px is not None
    assert halfway.held_out_px < 0.5
    assert len(halfway.residuals) > 5


def test_measures_that_are_estimates_are_solved(views: list[View]) -> None:
    shown = views[4]
    field = replace(shown.settings.field, penalty_width_m=1.03, width_m=2.25, center_circle_radius_m=0.243)
    size = shown.pixels.shape[1], shown.pixels.shape[0]
    start = start_from_lens(shown.start, size)
    solved = calibrate([shown.pixels], field, start, frees_measures=True)
    assert solved.accepted, solved.reasons
    for name, value in solved.measures_m.items():
        assert value == pytest.approx(getattr(shown.settings.field, name), abs=0.004), name
    refused = calibrate([shown.pixels], field, start)
    assert not refused.accepted
    assert "if the field had width_m = 2.3" in str(refused.reasons[-1])


def test_a_width_that_no_touch_line_tells_is_not_solved(views: list[View]) -> None:
    shown, covered = views[0], views[0].pixels.copy()
    field = shown.settings.field
    ends = np.linspace(-field.length_m / 2.0, field.length_m / 2.0, 400)
    for y in (-field.width_m / 2.0, field.width_m / 2.0):
        for column, row in shown.truth.pixel_from_field(np.column_stack([ends, np.full(400, y)])).astype(int):
            top, left = max(row - 14, 0), max(column - 14, 0)
            covered[top : row + 15, left : column + 15] = np.median(shown.pixels.reshape(-1, 3), axis=0)
    size = covered.shape[1], covered.shape[0]
    result = calibrate([covered], field, start_from_lens(shown.start, size), frees_measures=True)
    assert "how wide the field is" in " ".join(map(str, result.reasons))


def test_a_wall_s_edge_is_no_touch_line_whose_paint_tells_the_width() -> None:
    """White paint before a white wall looks like the wall alone; of a thin line that does not matter."""
    size = 780, 580
    wide, thin = view(0, field__line_width_m=0.045), view(0)
    for shown, is_refused in ((wide, True), (thin, False)):
        start = start_from_lens(shown.start, size)
        result = calibrate([shown.pixels], shown.settings.field, start, frees_measures=True)
        assert ("90 mm of the field's width" in " ".join(map(str, result.reasons))) == is_refused
        assert result.accepted != is_refused
        assert calibrate([shown.pixels], shown.settings.field, start).accepted


def reasons(pixels: Bytes, preset: str = "ssl-2002") -> str:
    field = load_settings(options={"field_preset": preset}).field
    result = calibrate([pixels], field, None)
    assert not result.accepted
    return " ".join(map(str, result.reasons))


def test_what_is_refused(views: list[View]) -> None:
    pixels = views[0].pixels
    assert "too dark" in reasons((pixels * 0.1).astype(np.uint8))
    assert "overexposed" in reasons(np.full_like(pixels, 255))
    assert "lines were found" in reasons(np.full_like(pixels, 90))
    side = 9
    sums = np.cumsum(np.cumsum(pixels.astype(np.float64), axis=0), axis=1)
    means = (sums[side:, side:] - sums[:-side, side:] - sums[side:, :-side] + sums[:-side, :-side]) / side**2
    assert "blurred" in reasons(means.astype(np.uint8))
    assert reasons(pixels, "vsss")
    assert reasons(pixels, "ssl-division-b")


def test_a_field_without_painted_lines_is_refused(views: list[View]) -> None:
    bare = replace(views[0].settings.field, line_width_m=0.0)
    result = calibrate([views[0].pixels], bare, None)
    assert "no painted lines" in str(result.reasons[0])
    assert "only 30x20 px" in str(from_start(views[0], views[0].pixels[:20, :30]).reasons[0])


def test_pictures_of_several_sizes_are_refused(views: list[View]) -> None:
    result = from_start(views[0], views[0].pixels, views[0].pixels[:, :-20])
    assert "several sizes" in str(result.reasons[0])


def test_a_caller_sees_progress_and_may_cancel(views: list[View]) -> None:
    shares = []

    def watch(_what: str, share: float) -> None:
        shares.append(share)
        if share >= 0.5:
            raise Cancelled

    with pytest.raises(Cancelled):
        calibrate([views[0].pixels], views[0].settings.field, None, progress=watch)
    assert shares == sorted(shares)


def lens_of(shown: View, **wrong: float) -> LensSettings:
    """The lens that took a picture, as if a board had told it."""
    truth = shown.settings.camera.pinhole
    return LensSettings(
        size_px=(780, 580),
        focal_px=truth.focal_px * wrong.get("focal", 1.0),
        center_px=truth.center_px,
        distortion=truth.distortion,
        focal_deviation_px=2.0,
        center_deviation_px=(0.5, 0.5),
        distortion_deviation=(2e-3, 5e-3, 1e-4, 1e-4),
    )


def test_with_a_measured_lens_the_lines_tell_the_height(views: list[View]) -> None:
    for shown in views[:3]:
        field, held = shown.settings.field, lens_of(shown)
        start = start_from_lens(shown.start, (780, 580), held=held)
        for begin in (start, None):
            result = calibrate([shown.pixels], field, begin, held=held)
            assert result.accepted, result.reasons
            assert result.camera.position_m[2] == pytest.approx(shown.truth.position_m[2], rel=0.01)
            assert result.height_deviation_m < 0.05
            assert not any("how high the camera is" in note for note in result.notes)
            assert floor_error_m(result.camera, shown.truth, field) < MAX_ERROR_M


def test_with_a_measured_lens_fewer_lines_are_enough() -> None:
    """A camera over a corner of the field, which sees less than half of it."""
    shown = view(3, camera__pinhole__position_m=(1.5, 0.9, 4.0))
    field, held = shown.settings.field, lens_of(shown)
    start = start_from_lens(shown.start, (780, 580), held=held)
    result = calibrate([shown.pixels], field, start, held=held)
    assert result.accepted, result.reasons
    assert result.coverage < 0.45
    assert floor_error_m(result.camera, shown.truth, field) < 0.003
    start = start_from_lens(shown.start, (780, 580), height_m=4.0)
    said = " ".join(map(str, calibrate([shown.pixels], field, start, advises=False).reasons))
    assert "of the field, 50% are needed" in said


def test_a_measured_lens_that_the_tape_contradicts_is_refused(views: list[View]) -> None:
    shown, held = views[0], lens_of(views[0], focal=1.15)
    start = start_from_lens(shown.start, (780, 580), held=held, height_m=float(shown.truth.position_m[2]))
    said = " ".join(map(str, calibrate([shown.pixels], shown.settings.field, start, held=held).reasons))
    assert "lens and lines put the camera" in said or "contradict the lens" in said


def test_a_lens_of_another_picture_size_is_refused(views: list[View]) -> None:
    with pytest.raises(SettingsError, match="accepted: 780x580 as the lens was measured with"):
        calibrate([views[0].pixels[:-2]], views[0].settings.field, None, held=lens_of(views[0]))


def test_a_camera_that_moved_between_the_pictures_is_named_with_the_picture(views: list[View]) -> None:
    shown = views[2]
    lower, far, slightly = (np.roll(shown.pixels, by, axis=(0, 1)) for by in ((5, 0), (0, -30), (0, 2)))
    (said,) = map(str, from_start(shown, shown.pixels, lower, shown.pixels).reasons)
    assert said.startswith("picture 2 shows the field 5.0 px below where the others show it. Did the camera move")
    assert said.endswith("Leave that picture out.")
    moved = from_start(shown, far, shown.pixels, shown.pixels)
    assert moved.pictures[0].shift_px == pytest.approx((-30.0, 0.0), abs=0.5)
    assert "picture 1 shows the field 30.0 px to the left of" in str(moved.reasons[0])
    near = from_start(shown, shown.pixels, slightly)
    assert near.accepted, near.reasons
    assert any("picture 2 shows the field 2.0 px to the right" in note for note in near.notes)


def test_a_picture_that_shows_no_lines_does_not_keep_the_others_from_it(views: list[View]) -> None:
    shown, covered = views[2], views[2].pixels.copy()
    covered[:, :480] = 90
    for poor in (np.full_like(shown.pixels, 90), covered):
        result = calibrate([poor, shown.pixels], shown.settings.field, None, names=["a.png", "b.png"])
        assert result.accepted, result.reasons
        assert floor_error_m(result.camera, shown.truth, shown.settings.field) < MAX_ERROR_M
        assert [one.name for one in result.pictures] == ["a.png", "b.png"]
    alone = calibrate([np.full_like(shown.pixels, 90), shown.pixels], shown.settings.field, None)
    assert "hardly any lines are seen in picture 1" in alone.notes
