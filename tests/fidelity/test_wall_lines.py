"""A line at a wall's foot is taken out at a right angle to the wall, wherever one looks at it."""

import numpy as np
import pytest

from vision_core.fidelity.reports import Report
from vision_core.fidelity.wall_lines import without_wall_lines
from vision_core.models.mirror import PAPER_MIRROR
from vision_core.protocol.messages import HIDDEN


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
