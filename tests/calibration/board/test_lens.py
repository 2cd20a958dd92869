"""A lens from rendered pictures of a board: how near to the truth, and what is missing when it is refused."""

from collections.abc import Sequence

import numpy as np
import pytest

from bench.board_views import LENS, POSES, SIZE_PX, board_pictures
from vision_core.calibration.board.corners import find_board
from vision_core.calibration.board.lens import calibrate_lens
from vision_core.calibration.board.result import LensCalibration
from vision_core.geometry import Bytes
from vision_core.models.camera import PinholeCamera

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def pictures() -> list[Bytes]:
    return board_pictures()


def measured(pictures: Sequence[Bytes]) -> LensCalibration:
    return calibrate_lens(pictures, [f"{number}.png" for number in range(1, len(pictures) + 1)])


def refusal(pictures: Sequence[Bytes]) -> str:
    result = measured(pictures)
    assert not result.accepted
    return "; ".join(map(str, result.reasons))


def test_the_lens_is_that_of_the_camera(pictures: list[Bytes]) -> None:
    result = measured(pictures)
    assert result.accepted, result.reasons
    lens = result.lens
    assert lens is not None
    assert abs(lens.focal_px - LENS.focal_px) < 3.0 * lens.focal_deviation_px
    assert np.hypot(*(np.array(lens.center_px) - LENS.center_px)) < 1.5
    assert result.rms_px < 0.2
    assert 0.4 < result.coverage < 1.0
    assert result.bend_error_px < 1.0
    grid = np.stack(np.meshgrid(np.linspace(-0.5, 0.5, 9), np.linspace(-0.4, 0.4, 9)), axis=-1).reshape(-1, 2)
    same = PinholeCamera(lens.focal_px, lens.center_px, lens.distortion, (0.0, 0.0, 1.0), (0.0, 0.0, 0.0))
    apart = same.pixel_from_field(grid) - LENS.pixel_from_field(grid)
    assert np.hypot(*(apart - apart.mean(axis=0)).T).max() < 1.0
    for picture, (_, turns) in zip(result.pictures, POSES, strict=True):
        assert picture.held_out_px is not None
        assert picture.held_out_px < 0.3
        assert picture.tilt_deg == pytest.approx(np.hypot(*turns[:2]), abs=2.5)


def test_too_few_boards_are_named_with_what_was_there_instead(pictures: list[Bytes]) -> None:
    empty, dark = np.full_like(pictures[0], 90), (pictures[1] * 0.02).astype(np.uint8)
    mirrored = np.ascontiguousarray(pictures[2][:, ::-1])
    said = refusal([pictures[0], empty, dark, mirrored, pictures[4]])
    assert "seen in 2 of 5 pictures, 4 are needed" in said
    assert "2.png (no board is seen: covered, blurred, or too small)" in said
    assert "3.png (it is too dark: 99 % of it is below level 4)" in said
    assert "4.png (it is a mirror image)" in said
    partial = pictures[3].copy()
    partial[:, 250:] = 90
    assert "corners of the board are seen" in str(find_board(partial)) or "no board" in str(find_board(partial))


def test_one_picture_without_a_board_is_a_note(pictures: list[Bytes]) -> None:
    result = measured([*pictures, np.full_like(pictures[0], 90)])
    assert result.accepted, result.reasons
    assert result.notes == ("the board is not seen in 8.png (no board is seen: covered, blurred, or too small)",)


def test_what_was_not_covered_is_named(pictures: list[Bytes]) -> None:
    kept = [picture for picture, (place, _) in zip(pictures, POSES, strict=True) if place[0] > 0 or place[1] < 0.1]
    assert "the lower left of the picture was never covered. Hold the board there too" in refusal(kept)


def test_boards_that_are_held_alike_tell_no_focal_length() -> None:
    places = [(-0.5, -0.3, 1.0), (0.5, -0.3, 1.1), (-0.5, 0.3, 0.9), (0.5, 0.3, 1.2)]
    flat = board_pictures([(place, (1.0, -1.0, 0.0)) for place in places])
    assert "all boards are parallel to the picture, the most tilted one by" in refusal(flat)
    alike = board_pictures([(place, (30.0, 0.0, 0.0)) for place in places])
    assert "all boards are tilted to the same side" in refusal(alike)


def test_a_board_that_is_not_flat_is_named(pictures: list[Bytes]) -> None:
    bent = pictures[4].copy()
    for column in range(SIZE_PX[0]):
        bent[:, column] = np.roll(bent[:, column], round(6.0 * np.sin(column / 60.0)), axis=0)
    said = refusal([*pictures[:4], bent, *pictures[5:]])
    assert "the board in 5.png lies" in said or "beside where one lens can see them" in said


def test_pictures_of_several_sizes(pictures: list[Bytes]) -> None:
    assert "several sizes: 470x360, 480x360" in refusal([pictures[0], pictures[1][:, :-10]])
