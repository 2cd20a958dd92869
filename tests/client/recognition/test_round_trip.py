"""A view that is drawn and recognized again is the view that was drawn, as far as 240 px show it."""

import numpy as np
import pytest

from tests.client.recognition.random_views import DrawnView, clear_directions, random_view
from vision_core.client.panorama import draw_panorama
from vision_core.client.recognition import DRAWN, PictureGeometry, Recognized, paper_geometry, recognize
from vision_core.models.mirror import PAPER_MIRROR, Mirror
from vision_core.protocol.messages import HIDDEN

VIEWS = 300
WIDE = Mirror(1.933098, 0.00296946, 360000.0)
"""Horizon at 252.6 px: the picture has 0.46 px for each."""


def there_and_back(view: DrawnView, mirror: Mirror = PAPER_MIRROR) -> Recognized:
    picture = draw_panorama(view.px, "".join(view.letters.tolist()), view.ball, mirror)
    return recognize(np.ascontiguousarray(picture[..., ::-1]), paper_geometry(mirror), DRAWN)


def test_types_are_equal_and_distances_within_a_pixel_in_random_views() -> None:
    rng = np.random.default_rng(20020622)
    clear = wrong_type = wrong_px = balls = wrong_ball = 0
    off = []
    for _ in range(VIEWS):
        view = random_view(rng)
        back = there_and_back(view)
        shown = clear_directions(view)
        clear += int(shown.sum())
        wrong_type += int((shown & (back.letters != view.letters)).sum())
        wrong_px += int((shown & (np.abs(back.px - view.px) > 1.0)).sum())
        off.append(np.mean(np.abs(back.px - view.px)[shown] > 0.0))
        if view.ball is None:
            continue
        balls += 1
        px, direction, size = view.ball
        aside = (back.ball.direction_deg - direction + 180.0) % 360.0 - 180.0
        wrong_ball += abs(back.ball.px - px) > 1 or abs(aside) > 1 or abs(back.ball.size_deg - size) > 3
    assert clear > 0.85 * 360 * VIEWS
    assert (wrong_type, wrong_px) == (0, 0)
    assert np.mean(off) < 0.01  # nearly all are even the same pixel
    assert balls > VIEWS // 2
    assert wrong_ball == 0


@pytest.mark.parametrize("letter", list("wuvxyrq"))
def test_every_type_is_recognized_at_every_distance(letter: str) -> None:
    for px in range(21, int(PAPER_MIRROR.horizon_px) - 2, 6):
        back = there_and_back(DrawnView(np.full(360, letter), np.full(360, float(px)), None))
        assert set(back.letters.tolist()) == {letter}
        assert np.abs(back.px - px).max() <= 1
        assert back.ball == HIDDEN


def test_the_ball_does_not_hide_the_edge_behind_it() -> None:
    view = DrawnView(np.full(360, "w"), np.full(360, 60.0), (58.0, 90.0, 8.0))
    back = there_and_back(view)
    assert set(back.letters.tolist()) == {"w"}
    assert np.abs(back.px - 60).max() <= 1
    assert (back.ball.px, back.ball.direction_deg) == (58, 90)


def test_a_ball_beyond_a_limit_of_paint_is_seen() -> None:
    back = there_and_back(DrawnView(np.full(360, "w"), np.full(360, 44.0), (61.0, 121.0, 6.0)))
    assert (back.ball.px, back.ball.direction_deg) == (61, 121)


def test_a_wide_horizon_costs_a_pixel_where_two_share_one() -> None:
    radii = 150.0 + 60.0 * np.sin(np.radians(2.0 * np.arange(360.0)))
    back = there_and_back(DrawnView(np.full(360, "w"), np.floor(radii), None), WIDE)
    assert set(back.letters.tolist()) == {"w"}
    assert np.abs(back.px - np.floor(radii)).max() <= 2


def test_nothing_within_range_stays_nothing() -> None:
    letters = np.where(np.arange(360) < 180, "w", "-")
    back = there_and_back(DrawnView(letters, np.where(letters == "w", 60.0, 255.0), None))
    clear = (np.arange(360) % 180 > 3) & (np.arange(360) % 180 < 177)
    assert (back.letters == letters)[clear].all()
    assert (back.px[clear] == np.where(letters == "w", 60, -1)[clear]).all()


def test_the_drawn_geometry_is_the_pictures() -> None:
    geometry = paper_geometry(PAPER_MIRROR)
    assert isinstance(geometry, PictureGeometry)
    columns, rows = geometry.pixel_from_px(np.array([10.0, 0.0]), np.array([0.0, 10.0]))
    assert columns.tolist() == [159.5, 149.5]
    assert rows.tolist() == [109.5, 119.5]
    radius, direction = geometry.px_from_pixel(columns, rows)
    assert radius.tolist() == [10.0, 10.0]
    assert direction.tolist() == [0.0, 90.0]
