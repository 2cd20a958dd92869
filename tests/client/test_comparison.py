"""Two views compared: what counts as the same, the errors of distances, and the drawing."""

import math

import numpy as np
import pytest

from vision_core.client.comparison import DIFFERENT, SAME, compare, draw_comparison, fold
from vision_core.client.panorama import HEIGHT_PX, WIDTH_PX
from vision_core.client.view import View
from vision_core.geometry import Floats
from vision_core.models.mirror import PAPER_MIRROR
from vision_core.protocol.messages import HIDDEN, Ball
from vision_core.protocol.options import Options


def view(letters: str, px: Floats | float = 60.0, ball: Ball = HIDDEN) -> View:
    radii = np.full(len(letters), px, dtype=np.float64)
    return View(
        time_s=1.0,
        letters=np.array(list(letters)),
        px=radii.astype(np.int16),
        mm=PAPER_MIRROR.mm_from_px(radii),
        directions_deg=np.arange(len(letters)) * 360.0 / len(letters),
        ball=ball,
        ball_mm=math.inf,
    )


def test_numbers_of_robots_are_folded_to_teams() -> None:
    assert "".join(fold(np.array(list("wABPabpqxyruv-")))) == "wxxxyyyqxyruv-"


def test_a_type_one_direction_aside_is_the_same_two_are_not() -> None:
    told = view("w" * 10 + "A" * 10 + "w" * 10)
    assert compare(view("w" * 11 + "x" * 10 + "w" * 9), told).share == 1.0
    two = compare(view("w" * 12 + "x" * 10 + "w" * 8), told)
    assert np.flatnonzero(~two.same_type).tolist() == [11, 21]


def test_a_robot_without_a_team_is_like_any_robot() -> None:
    assert compare(view("x" * 9 + "y" * 9), view("r" * 18)).share == 1.0
    assert compare(view("r" * 18), view("A" * 18)).share == 1.0
    assert compare(view("x" * 18), view("y" * 18)).share == 0.0
    assert compare(view("q" * 18), view("r" * 18)).share == 0.0


def test_distances_are_compared_with_the_nearest_of_three() -> None:
    px = np.repeat([50.0, 60.0, 70.0], 10)
    same = compare(view("w" * 30, np.roll(px, 1)), view("w" * 30, px))
    assert (same.median_px, same.p95_px) == (0.0, 0.0)
    off = compare(view("w" * 30, px + 3.0), view("w" * 30, px))
    assert (off.median_px, off.error_px.min(), off.error_px.max()) == (3.0, 3.0, 3.0)
    assert "3.0 px (median)" in off.sentence


def test_where_one_sees_nothing_there_is_no_distance() -> None:
    nothing = compare(view("-" * 8, -1.0), view("w" * 8))
    assert np.isnan(nothing.error_px).all()
    assert math.isnan(nothing.median_px)
    assert math.isnan(nothing.ball_px)
    assert nothing.share == 0.0


def test_balls_are_compared_when_both_see_one() -> None:
    near, far = view("w" * 8, ball=Ball(50, 10, 6)), view("w" * 8, ball=Ball(53, 10, 6))
    assert compare(far, near).ball_px == 3.0
    assert compare(far, near).sentence.endswith("ball by +3 px")
    assert math.isnan(compare(far, view("w" * 8)).ball_px)


def test_the_drawing_shows_both_and_where_they_differ() -> None:
    told = view("w" * 360, 60.0)
    seen = view("w" * 180 + "x" * 180, np.repeat([60.0, 68.0], 180))
    drawn = draw_comparison(seen, told, PAPER_MIRROR, Options())
    assert drawn.shape[1:] == (2 * WIDTH_PX, 3)
    assert (drawn[:HEIGHT_PX, :WIDTH_PX] != drawn[:HEIGHT_PX, WIDTH_PX:]).any()
    strip = drawn[HEIGHT_PX + 6]
    assert tuple(strip[100]) == SAME
    assert tuple(strip[500]) == DIFFERENT
    filled = (drawn[-60:].sum(axis=2) > 600).sum(axis=0)
    assert filled[100] == 0
    assert filled[500] == 48  # 8 of 10 px


def test_other_directions_are_refused() -> None:
    with pytest.raises(ValueError, match="30 and 36 directions"):
        compare(view("w" * 30), view("w" * 36))
