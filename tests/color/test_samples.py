"""Classes by samples: a reference with its spread; what agrees best decides, and nothing reaches too far."""

import msgspec
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from vision_core.color.explain import verdicts
from vision_core.color.lookup_table import cell_centers, compile_color_table
from vision_core.color.samples import (
    Measured,
    bgr_from_hex,
    claims_by_samples,
    distances,
    hex_from_bgr,
    measured_from,
    places_of,
    references_from,
)
from vision_core.settings.schema import ColorRange, SamplingSettings
from vision_core.venues.loader import load_settings

COLORS = load_settings().colors
SAMPLING = SamplingSettings(spread=0.12, tolerance=3.5)
SAMPLES = {
    "orange": ("#e06a2c", "#b84e1f"),
    "none": ("#3c7a44", "#d8dcd2"),
    "blue": ("#2050c0",),
}
BOTH = msgspec.structs.replace(
    COLORS,
    space="ymp",
    classes={"pink": (ColorRange(phase_deg=(35.0, 95.0), module=(38.0, 181.0)),)},
    samples=SAMPLES,
    sampling=SAMPLING,
)
LEVEL = st.integers(0, 255)


@given(LEVEL, LEVEL, LEVEL)
def test_hex_is_a_name_of_a_color(blue: int, green: int, red: int) -> None:
    text = hex_from_bgr((blue, green, red))
    assert bgr_from_hex(text) == (blue, green, red)
    assert text == f"#{red:02x}{green:02x}{blue:02x}"


def test_a_class_keeps_its_colors_in_half_the_light_and_loses_them_to_glare_and_dark() -> None:
    paper = np.array([[200.0, 110.0, 30.0]])
    measured = Measured({"blue": paper}, np.zeros((0, 3)))
    off = distances(np.array([paper[0], 0.5 * paper[0], 0.1 * paper[0], [200.0, 200.0, 200.0]]), measured, SAMPLING)[
        :, 0
    ]
    assert off[0] == pytest.approx(0.0, abs=1e-6)
    assert off[1] < SAMPLING.tolerance < off[2]
    assert off[3] > SAMPLING.tolerance


@given(LEVEL, LEVEL, LEVEL)
def test_at_most_one_class_claims_a_color(blue: int, green: int, red: int) -> None:
    places = places_of(np.array([[blue, green, red]], dtype=np.float64))
    claims = claims_by_samples(places, measured_from(SAMPLES), SAMPLING)
    assert list(claims) == ["orange", "blue"]
    assert sum(int(claim[0]) for claim in claims.values()) <= 1


def test_a_dark_carpet_does_not_claim_a_bright_paper_of_its_hue() -> None:
    paper, carpet = np.array([[90.0, 220.0, 80.0]]), np.array([[35.0, 80.0, 30.0]])
    measured = Measured({"green": paper}, carpet)
    claims = claims_by_samples(places_of(np.concatenate([paper, carpet])), measured, SAMPLING)["green"]
    assert claims.tolist() == [True, False]


def test_many_samples_tell_the_spread() -> None:
    rng = np.random.default_rng(1)
    papers = np.exp(rng.normal(np.log([60.0, 80.0, 200.0]), 0.3, (200, 3)))
    wide, narrow = (
        references_from(Measured({"red": rows}, papers[:0]), 0.1).spreads[0] for rows in (papers, papers[:1])
    )
    assert wide[0] > 2.0 * narrow[0]


def test_samples_join_the_one_table_behind_the_ranges() -> None:
    table = compile_color_table(BOTH)
    assert table.names == ("", "pink", "orange", "blue")
    for name in ("orange", "blue"):
        for text in SAMPLES[name]:
            assert table.classes_of(np.array(bgr_from_hex(text), dtype=np.uint8)) == table.index(name)
    for text in SAMPLES["none"]:
        assert table.classes_of(np.array(bgr_from_hex(text), dtype=np.uint8)) == 0


def test_no_samples_claim_nothing() -> None:
    cells = places_of(cell_centers())
    assert claims_by_samples(cells, measured_from({}), SAMPLING) == {}
    claims = claims_by_samples(cells, measured_from({"orange": (), "none": ("#000000",)}), SAMPLING)
    assert not claims["orange"].any()


def test_verdicts_agree_with_the_table_and_name_the_miss() -> None:
    table = compile_color_table(BOTH)
    rng = np.random.default_rng(2)
    cells = cell_centers()
    for index in rng.integers(0, len(cells), 300):
        found = [verdict.name for verdict in verdicts(cells[index], BOTH) if verdict.claims]
        assert (found[0] if found else "") == table.names[table.classes[index]]
    pink, orange, blue = verdicts(np.array([0x1F, 0x4E, 0xB8], dtype=np.float64), BOTH)
    assert "phase_deg" in pink.why
    assert "misses 35..95 by" in pink.why
    assert orange.claims
    assert not blue.claims
    assert "spreads from the samples" in blue.why


def test_a_grey_is_told_to_have_no_hue() -> None:
    settings = msgspec.structs.replace(COLORS, space="ec", classes={"red": (ColorRange(hue_deg=(80.0, 120.0)),)})
    (red,) = verdicts(np.array([90.0, 90.0, 90.0]), settings)
    assert "too grey" in red.why
