"""A line at a wall's foot is taken out at a right angle to the wall, wherever one looks at it."""

import numpy as np
import pytest

from vision_core.fidelity.reports import Report
from vision_core.fidelity.wall_lines import line_at_walls_mm, without_wall_lines
from vision_core.models.mirror import PAPER_MIRROR
from vision_core.protocol.messages import HIDDEN
from vision_core.venues.loader import load_settings


def test_a_straight_wall_moves_away_by_the_width_of_the_line() -> None:
    angles = np.radians(np.arange(360.0))
    ahead = np.abs(np.degrees(angles) - 180.0) > 110.0
    mm = np.where(ahead, 500.0 / np.where(ahead, np.cos(angles), 1.0), np.inf)
    radii = np.where(ahead, PAPER_MIRROR.px_from_mm(np.where(ahead, mm, 0.0)), np.inf)
    seen = Report(np.where(ahead, "w", "-"), radii, HIDDEN)
    found = without_wall_lines(seen, 10.0, PAPER_MIRROR)
    middle = np.flatnonzero(ahead & (np.roll(ahead, 3) & np.roll(ahead, -3)))
    assert PAPER_MIRROR.mm_from_px(found.radii_px[middle]) == pytest.approx(mm[middle] * 510.0 / 500.0)


def test_other_edges_stay() -> None:
    seen = Report(np.array(list("yyyyyyyy")), np.full(8, 50.0), HIDDEN)
    assert without_wall_lines(seen, 10.0, PAPER_MIRROR).radii_px.tolist() == [50.0] * 8


@pytest.mark.parametrize(("preset", "width_mm"), [("ssl-2002", 10.0), ("ssl-division-b", 0.0)])
def test_only_walls_at_the_lines_have_one(preset: str, width_mm: float) -> None:
    assert line_at_walls_mm(load_settings(options={"field_preset": preset}).field) == pytest.approx(width_mm)
