"""Equation 1 against the worked example of its derivation, and every rule that refuses a mirror."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from vision_core.errors import SettingsError
from vision_core.models.mirror import Mirror, check_span

PAPER = Mirror(4.0187, 0.0125935, 90000.0)
"""h 219 mm, u 1.739, f 300 px: the mirror that the paper's own numbers imply."""
TABLE = [
    # r mm, R px, hex, dr/dR mm, as printed
    (110, "25.0", "19", "4.9"),
    (150, "32.7", "20", "5.5"),
    (220, "44.0", "2c", "7.0"),
    (300, "54.0", "35", "9.3"),
    (380, "61.5", "3d", "12"),
    (500, "69.8", "45", "17"),
    (700, "78.8", "4e", "29"),
    (1000, "86.6", "56", "52"),
    (1500, "93.3", "5d", "106"),
    (2000, "96.9", "60", "180"),
    (2750, "100.0", "63", "329"),
]


@pytest.mark.parametrize(("r_mm", "r_px", "digits", "slope"), TABLE)
def test_the_worked_example_to_the_printed_digits(r_mm: float, r_px: str, digits: str, slope: str) -> None:
    found = PAPER.px_from_mm(r_mm)
    assert f"{found:.1f}" == r_px
    assert f"{int(found):02x}" == digits
    mm_per_px = (PAPER.mm_from_px(found + 1e-4) - PAPER.mm_from_px(found - 1e-4)) / 2e-4
    assert f"{mm_per_px:.{1 if '.' in slope else 0}f}" == slope


def test_the_horizon() -> None:
    assert f"{PAPER.horizon_px:.1f}" == "108.8"
    assert PAPER.px_from_mm(1e12) == pytest.approx(PAPER.horizon_px)
    assert PAPER.px_from_mm(1e12) < PAPER.horizon_px
    assert PAPER.mm_from_px(PAPER.horizon_px + 1e-9) == math.inf
    assert PAPER.mm_from_px(254.0) == math.inf


def test_the_origin() -> None:
    assert PAPER.px_from_mm(0.0) == 0.0
    assert PAPER.mm_from_px(0.0) == 0.0


@st.composite
def mirrors(draw: st.DrawFn) -> Mirror:
    """Valid mirrors, made from focal length [px] and horizon [px] and height [mm]."""
    f, horizon = draw(st.floats(50.0, 2000.0)), draw(st.floats(20.5, 253.5))
    h = draw(st.floats(50.0, 3000.0))
    u = math.asinh(f / horizon)  # R_max = f / sinh(u)
    return Mirror(f * math.cosh(u) / h, math.sinh(u) / h, f * f)


@given(mirrors())
def test_round_trip_from_millimetres(mirror: Mirror) -> None:
    r = np.concatenate([[0.0], np.geomspace(1e-3, 1e6, 500)])
    np.testing.assert_allclose(mirror.mm_from_px(mirror.px_from_mm(r)), r, rtol=2e-7)


@given(mirrors(), st.floats(0.0, 0.999))
def test_round_trip_from_pixels(mirror: Mirror, share: float) -> None:
    r_px = share * mirror.horizon_px
    assert mirror.px_from_mm(mirror.mm_from_px(r_px)) == pytest.approx(r_px, rel=1e-9, abs=1e-12)


def test_round_trip_of_the_papers_mirror_from_0_to_a_kilometre() -> None:
    r = np.linspace(0.0, 1e6, 20_001)
    np.testing.assert_allclose(PAPER.mm_from_px(PAPER.px_from_mm(r)), r, rtol=1e-9)


@given(mirrors())
def test_the_radius_grows_with_distance_at_a_falling_rate(mirror: Mirror) -> None:
    px = mirror.px_from_mm(np.geomspace(1.0, 1e5, 200))
    assert (np.diff(px) > 0.0).all()
    spans = np.diff(mirror.mm_from_px(np.linspace(0.0, 0.99 * mirror.horizon_px, 200)))
    assert (np.diff(spans) > 0.0).all()


@pytest.mark.parametrize(
    ("a", "b", "c", "rule"),
    [
        (math.nan, 0.0126, 90000.0, "finite"),
        (4.0187, math.inf, 90000.0, "finite"),
        (4.0187, 0.0126, -math.inf, "finite"),
        (4.0187, 0.0125935, 0.0, "C > 0"),  # conical
        (4.0187, 0.0125935, -90000.0, "C > 0"),
        (4.0187, -0.0125935, 90000.0, "B >= 0"),  # the other sheet
        (3.77805, 0.0125935, 90000.0, r"A > B sqrt\(C\)"),  # singular
        (-4.0187, 0.0125935, 90000.0, r"A > B sqrt\(C\)"),
        (4.0, 0.0, 90000.0, "20..254 px"),  # linear: no horizon
        (3.7781, 0.0125935, 90000.0, "20..254 px"),  # horizon 3 px
        (6.0, 0.0125935, 90000.0, "20..254 px"),  # horizon 370 px
    ],
)
def test_impossible_constants_are_refused_with_the_rule_that_they_violate(
    a: float, b: float, c: float, rule: str
) -> None:
    with pytest.raises(SettingsError, match=rule):
        Mirror(a, b, c)


def test_a_field_that_the_mirror_cannot_resolve_is_refused() -> None:
    check_span(PAPER, 3.6)
    check_span(PAPER, 0.5)  # smaller than a metre: nothing to resolve
    with pytest.raises(SettingsError, match="at least 3 px"):
        check_span(PAPER, 1.1)
