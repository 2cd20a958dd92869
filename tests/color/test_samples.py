"""Classes by samples: the nearest sample decides, and nothing reaches farther than the tolerance."""

import msgspec
import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from vision_core.color.explain import verdicts
from vision_core.color.lookup_table import cell_centers, compile_color_table
from vision_core.color.samples import bgr_from_hex, claims_by_samples, hex_from_bgr, nearest_samples
from vision_core.color.spaces import ycc_from_bgr
from vision_core.settings.schema import ColorRange, SamplingSettings
from vision_core.venues.loader import load_settings

COLORS = load_settings().colors
SAMPLING = SamplingSettings(tolerance=25.0, luma_weight=0.3)
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


@given(LEVEL, LEVEL, LEVEL)
def test_the_nearest_sample_within_tolerance_decides(blue: int, green: int, red: int) -> None:
    bgr = np.array([[blue, green, red]], dtype=np.float64)
    scale = np.array([0.3, 1.0, 1.0])
    flat = [(name, text) for name, texts in SAMPLES.items() for text in texts]
    distances = [
        float(np.linalg.norm((ycc_from_bgr(bgr) - ycc_from_bgr([bgr_from_hex(text)])) * scale)) for _, text in flat
    ]
    best = int(np.argmin(distances))
    near = distances[best] <= SAMPLING.tolerance
    claims = claims_by_samples(bgr, SAMPLES, SAMPLING)
    assert list(claims) == ["orange", "blue"]
    for name, claim in claims.items():
        assert bool(claim[0]) == (near and flat[best][0] == name)


def test_samples_join_the_one_table_behind_the_ranges() -> None:
    table = compile_color_table(BOTH)
    assert table.names == ("", "pink", "orange", "blue")
    for name in ("orange", "blue"):
        for text in SAMPLES[name]:
            assert table.classes_of(np.array(bgr_from_hex(text), dtype=np.uint8)) == table.index(name)
    for text in SAMPLES["none"]:
        assert table.classes_of(np.array(bgr_from_hex(text), dtype=np.uint8)) == 0


def test_no_samples_claim_nothing() -> None:
    assert claims_by_samples(cell_centers(), {}, SAMPLING) == {}
    assert np.isinf(nearest_samples(cell_centers(), {}, SAMPLING)[1]).all()
    claims = claims_by_samples(cell_centers(), {"orange": (), "none": ("#000000",)}, SAMPLING)
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
    assert "away" in blue.why


def test_a_grey_is_told_to_have_no_hue() -> None:
    settings = msgspec.structs.replace(COLORS, space="ec", classes={"red": (ColorRange(hue_deg=(80.0, 120.0)),)})
    (red,) = verdicts(np.array([90.0, 90.0, 90.0]), settings)
    assert "too grey" in red.why
