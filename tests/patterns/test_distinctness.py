"""The figures of patterns: how ids and headings are told apart."""

import pytest

from vision_core.patterns.distinctness import MIN_PX, nearest_rival, report_on
from vision_core.patterns.loader import load_pattern
from vision_core.venues.loader import config_folder

SHIPPED = sorted(path.stem for path in (config_folder() / "patterns").glob("*.toml"))


@pytest.mark.parametrize("name", SHIPPED)
def test_shipped_patterns_are_told_apart(name: str) -> None:
    report = report_on(load_pattern(name))
    assert (report.fewest_differences is None) == (report.ids == 1)
    assert report.fewest_differences is None or report.fewest_differences >= 1
    assert report.rival is None or report.rival.off_mm > 12.0
    assert report.coarsest_mm_per_px * MIN_PX == pytest.approx(report.smallest_mm)
    assert report.smallest_mm > 20.0


def test_the_standard_pattern() -> None:
    """All 16 codes of four dots in two colors are ids; 90 degrees on, one is nearest to another."""
    report = report_on(load_pattern("ssl-standard"))
    assert (report.ids, report.turns, report.fewest_differences, report.smallest_mm) == (16, 1, 1, 40.0)
    assert set(report.colors) == {"blue", "yellow", "green", "pink"}
    assert report.rival is not None
    assert report.rival.off_mm == pytest.approx(17.9, abs=0.5)


def test_turns_that_only_colors_tell_apart() -> None:
    report = report_on(load_pattern("mirosot-quarters"))
    assert (report.turns, report.fewest_differences) == (4, 2)


def test_patterns_seen_together() -> None:
    ssl, diagonal = load_pattern("ssl-standard"), load_pattern("vsss-diagonal")
    rival = nearest_rival(ssl, load_pattern("sdp-plate"))
    assert rival is not None
    assert rival.off_mm < 15.0
    apart = nearest_rival(ssl, diagonal)
    assert apart is None or apart.off_mm > 50.0
    assert nearest_rival(ssl, load_pattern("t-plate")) is None
