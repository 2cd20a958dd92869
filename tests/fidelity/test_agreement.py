"""Reports are compared within a direction and a pixel."""

import numpy as np

from vision_core.fidelity.agreement import compare
from vision_core.fidelity.reports import Report
from vision_core.protocol.messages import HIDDEN


def report(letters: str, *radii_px: float) -> Report:
    return Report(np.array(list(letters)), np.array(radii_px), HIDDEN)


def test_a_type_one_direction_aside_agrees_and_two_aside_does_not() -> None:
    first = report("wwwwwyww", *[90.0] * 5, 60.0, 90.0, 90.0)
    assert compare(first, report("wwwwwwyw", *[90.0] * 6, 60.0, 90.0)).agrees.all()
    assert not compare(first, report("wwwwwwwy", *[90.0] * 7, 60.0)).same_type[5]


def test_of_several_neighbors_of_the_same_type_the_nearest_radius_counts() -> None:
    found = compare(report("www", 80.2, 90.0, 70.0), report("www", 83.9, 81.0, 70.0))
    assert found.error_px.tolist() == [-1.0, 7.0, 0.0]
    assert found.agrees.tolist() == [True, False, True]


def test_nothing_agrees_with_nothing_and_with_no_edge() -> None:
    found = compare(report("--w", np.inf, np.inf, 50.0), report("---", np.inf, np.inf, np.inf))
    assert found.agrees.tolist() == [True, True, False]


def test_a_report_meets_a_finer_one() -> None:
    finer = report("wwwwyyyywwww", *[90.0] * 4, *[50.0] * 4, *[90.0] * 4)
    assert compare(report("wyw", 90.0, 50.0, 90.0), finer).agrees.all()
