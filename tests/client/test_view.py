"""A see as arrays."""

import math

import numpy as np
import pytest

from vision_core.client.view import view_from_see
from vision_core.models.from_settings import mirror_of
from vision_core.models.mirror import PAPER_MIRROR
from vision_core.protocol.messages import HIDDEN, Ball, See
from vision_core.protocol.options import PAPER_OPTIONS, Options
from vision_core.types.objects import Team
from vision_core.venues.loader import load_settings


def test_the_papers_mirror_is_that_of_the_papers_field() -> None:
    assert mirror_of(load_settings(options={"field_preset": "ssl-2002"}).mirror, Team.BLUE) == PAPER_MIRROR


def test_the_papers_sample() -> None:
    view = view_from_see(See(20306_148000, b"r59r5ar5av3e", Ball(61, 121, 3)), PAPER_OPTIONS, PAPER_MIRROR)
    assert view.time_s == 20306.148
    assert view.letters.tolist() == ["r", "r", "r", "v"]
    assert view.px.tolist() == [0x59, 0x5A, 0x5A, 0x3E]
    assert view.directions_deg.tolist() == [0.0, 1.0, 2.0, 3.0]
    assert 373.0 < view.ball_mm < 385.0


def test_a_pixel_stands_for_its_middle() -> None:
    view = view_from_see(See(0, b"w00w2cwFE-ff", HIDDEN), PAPER_OPTIONS, PAPER_MIRROR)
    assert view.px.tolist() == [0, 0x2C, 0xFE, -1]
    assert view.mm[:2].tolist() == [PAPER_MIRROR.mm_from_px(0.5), PAPER_MIRROR.mm_from_px(44.5)]
    assert view.mm[2:].tolist() == [math.inf, math.inf]  # beyond the horizon, and nothing
    assert view.ball_mm == math.inf


def test_distances_come_back_within_their_pixel() -> None:
    truth = np.linspace(100.0, 2500.0, 360)
    px = PAPER_MIRROR.px_from_mm(truth).astype(int)
    edges = b"".join(b"w%02x" % value for value in px)
    view = view_from_see(See(0, edges, HIDDEN), PAPER_OPTIONS, PAPER_MIRROR)
    assert np.all(truth >= PAPER_MIRROR.mm_from_px(px.astype(np.float64)))
    assert np.all(view.mm < PAPER_MIRROR.mm_from_px(px + 1.0))
    assert np.all(np.abs(view.mm - truth) < PAPER_MIRROR.mm_from_px(px + 1.0) - PAPER_MIRROR.mm_from_px(px + 0.0))


def test_directions_follow_the_options() -> None:
    options = Options(fov_deg=90.0, center_deg=0.0, resolution_deg=30.0)
    view = view_from_see(See(0, b"w10" * 3, HIDDEN), options, PAPER_MIRROR)
    assert view.directions_deg.tolist() == [315.0, 345.0, 15.0]


def test_unknown_letters_are_kept_and_an_empty_see_is_empty() -> None:
    view = view_from_see(See(0, b"~10!11", HIDDEN), PAPER_OPTIONS, PAPER_MIRROR)
    assert view.letters.tolist() == ["~", "!"]
    assert len(view_from_see(See(0, b"", HIDDEN), PAPER_OPTIONS, PAPER_MIRROR).px) == 0


def test_a_printed_view_is_one_short_line() -> None:
    see = See(20306_148000, b"w2c" * 359 + b"-ff", Ball(61, 121, 3))
    view = view_from_see(see, PAPER_OPTIONS, PAPER_MIRROR)
    expected = "View(20306.148 s, 360 edges, nearest w at 0.22 m, 0 deg, ball at 0.38 m, 121 deg)"
    assert (str(view), repr(view)) == (expected, expected)
    empty = view_from_see(See(0, b"-ff", HIDDEN), PAPER_OPTIONS, PAPER_MIRROR)
    assert repr(empty) == "View(0.000 s, 1 edges, nothing near, ball hidden)"
    assert repr(view_from_see(See(0, b"", HIDDEN), PAPER_OPTIONS, PAPER_MIRROR)).startswith("View(0.000 s, 0 edges")


@pytest.mark.parametrize("name", ["letters", "px", "mm", "directions_deg"])
def test_arrays_are_read_only(name: str) -> None:
    view = view_from_see(See(0, b"w10", HIDDEN), PAPER_OPTIONS, PAPER_MIRROR)
    with pytest.raises(ValueError, match="read-only"):
        getattr(view, name)[0] = 0
