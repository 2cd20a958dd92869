"""The cheap test refuses no color that the table gives a class to, and is refused nothing it needs by rounding."""

import numpy as np
import pytest
from numpy.typing import NDArray

from tests.conftest import ROOT
from vision_core.color.lookup_table import cell_centers, compile_color_table
from vision_core.color.prefilter import fit_conditions, prefilter_from
from vision_core.color.spaces import hsv_from_bgr
from vision_core.geometry import Bytes
from vision_core.types.colors import ColorTable, References
from vision_core.types.prefilter import ColorPrefilter
from vision_core.venues.loader import load_settings

Mask = NDArray[np.bool_]
VENUES = sorted(path.stem for path in (ROOT / "config" / "venues").glob("*.toml"))


def passes(colors: Bytes, test: ColorPrefilter) -> Mask:
    """What ``ColorPrefilter`` says, in whole numbers: shape (n, 3) -> shape (n,)."""
    channels = colors.astype(np.int64).T
    step, level = test.margin_limit.astype(np.int64), test.level_limit.astype(np.int64)
    passed = (channels.min(axis=0) > level[6]) | (channels.max(axis=0) < level[7])
    for number in range(3):
        channel, others = channels[number], channels[[(number + 1) % 3, (number + 2) % 3]]
        largest, smallest = others.max(axis=0), others.min(axis=0)
        passed |= (channel - largest > step[number]) & (channel > level[number])
        passed |= (smallest - channel > step[number + 3]) & (smallest > level[number + 3])
    return np.asarray(passed)


def corners(table: ColorTable) -> Bytes:
    """The eight corners of every cell with a class: where a test of steps and levels is hardest to pass."""
    cells = np.flatnonzero(table.classes)
    low = np.column_stack([(cells >> 11) * 8, (cells >> 5 & 63) * 4, (cells & 31) * 8])
    ends = [low + np.array([b, g, r]) for b in (0, 7) for g in (0, 3) for r in (0, 7)]
    return np.concatenate(ends).astype(np.uint8)


def table_of(classes: Bytes) -> ColorTable:
    return ColorTable(
        ("", "a"), classes, np.zeros((2, 3), np.uint8), (), References(np.zeros((2, 2)), np.zeros((2, 3)))
    )


def assert_sound(table: ColorTable) -> ColorPrefilter:
    test = prefilter_from(table)
    assert passes(corners(table), test).all()
    inside = np.random.default_rng(1).integers(0, 256, (50_000, 3), dtype=np.uint8)
    assert passes(inside[table.classes_of(inside) > 0], test).all()
    return test


@pytest.mark.parametrize("venue", [None, *VENUES])
def test_every_color_with_a_class_passes(venue: str | None) -> None:
    assert_sound(compile_color_table(load_settings(venue=venue).colors))


def test_every_color_of_any_palette_passes() -> None:
    rng = np.random.default_rng(2)
    hue, saturation, value = hsv_from_bgr(cell_centers()).T
    for _ in range(60):
        low, span = rng.uniform(0, 360), rng.uniform(5, 90)
        least, most = np.sort(rng.random((2, 2)), axis=0)
        inside = ((hue - low) % 360.0 <= span) & (least[0] <= saturation) & (saturation <= most[0])
        assert_sound(table_of((inside & (least[1] <= value) & (value <= most[1])).astype(np.uint8)))


def test_any_set_of_cells_passes() -> None:
    rng = np.random.default_rng(3)
    for count in (1, 2, 10, 1000, 65536):
        classes = np.zeros(65536, dtype=np.uint8)
        classes[rng.choice(65536, count, replace=False)] = 1
        assert_sound(table_of(classes))


def test_greys_white_and_black_pass() -> None:
    for low, high in ((0, 40), (100, 150), (200, 255)):
        levels = np.arange(low, high + 1, dtype=np.uint8)
        greys = np.column_stack([levels, levels, levels])
        classes = np.zeros(65536, dtype=np.uint8)
        classes[(levels.astype(np.intp) >> 3) << 11 | (levels.astype(np.intp) >> 2) << 5 | levels >> 3] = 1
        assert passes(greys, assert_sound(table_of(classes))).all()


def test_most_other_colors_fail() -> None:
    table = compile_color_table(load_settings().colors)
    greys = np.repeat(np.arange(256, dtype=np.uint8)[:, None], 3, axis=1)
    assert not passes(greys, prefilter_from(table)).any()
    everything = np.random.default_rng(4).integers(0, 256, (50_000, 3), dtype=np.uint8)
    assert not passes(everything, prefilter_from(table_of(np.zeros(65536, dtype=np.uint8)))).any()


def test_one_compilation_and_read_only_limits() -> None:
    test = prefilter_from(compile_color_table(load_settings().colors))
    prefilter_from(table_of(np.ones(65536, dtype=np.uint8)))
    assert not test.margin_limit.flags.writeable
    assert len(fit_conditions.signatures) == 1  # type: ignore[attr-defined]
