"""What is derived from a pattern: areas, codes, and how many patches determine the heading."""

import math

import msgspec
import numpy as np
import pytest

from tests.objects.drawing import PAINT_TABLE, SETTINGS, TABLE
from tests.objects.finding import SHIPPED
from vision_core.errors import SettingsError
from vision_core.objects.robots.markers import ANCHOR_ROLE, NO_DIGIT, Marker, marker_of
from vision_core.patterns.loader import load_pattern
from vision_core.patterns.pattern import Code, Patch, Pattern
from vision_core.settings.schema import TeamRobotSettings
from vision_core.types.colors import ColorTable
from vision_core.types.objects import Team


def marker(pattern: Pattern, table: ColorTable = PAINT_TABLE) -> Marker:
    shape = pattern.robot
    robots = TeamRobotSettings(
        pattern=pattern.name, outline=shape.outline, radius_m=shape.radius_m, height_m=shape.height_m
    )
    return marker_of(pattern, robots, Team.BLUE, 0, table, SETTINGS.robots.dot_tolerance_m)


@pytest.mark.parametrize(
    ("name", "min_slots", "with_shape"),
    [("ssl-standard", 3, 3), ("vsss-three-patch", 2, 1), ("vsss-diagonal", 1, 1), ("mirosot-quarters", 2, 2)],
)
def test_so_many_patches_determine_the_heading(name: str, min_slots: int, with_shape: int) -> None:
    made = marker(load_pattern(name))
    assert (made.min_slots_for_heading, made.min_slots_with_shape) == (min_slots, with_shape)


@pytest.mark.parametrize("name", ["t-plate", "mirosot-diagonal", "vsss-corner-patch"])
def test_some_team_patches_determine_it_by_their_shape(name: str) -> None:
    assert marker(load_pattern(name)).min_slots_with_shape == 0


def test_a_marker_that_repeats_never_determines_it() -> None:
    """Two dots of one class, on both sides of the center: half a turn changes nothing."""
    ssl = load_pattern("ssl-standard")
    sides = tuple(Patch(color="pink", circle_mm=(0.0, y, 40.0)) for y in (50.0, -50.0))
    code = Code(colors=(), ids={"1": ""})
    made = marker(msgspec.structs.replace(ssl, patches=(ssl.patches[0], *sides), code=code))
    assert made.min_slots_for_heading == 3 > len(made.slots_m)


@pytest.mark.parametrize("name", SHIPPED)
def test_patches_are_as_drawn(name: str) -> None:
    pattern = load_pattern(name)
    made = marker(pattern)
    assert made.area_fractions.sum() == pytest.approx(1.0)
    assert len(made.slots_m) == len(made.digits) == len(pattern.patches) - 1
    assert sorted(made.ids) == sorted(pattern.code_by_id)
    assert len(set(made.codes.tolist())) == len(made.codes)
    assert made.color_roles[PAINT_TABLE.index("blue")] & ANCHOR_ROLE
    assert made.slots_m - made.anchor_m == pytest.approx(made.slot_offsets_m)
    assert not made.slots_m.flags.writeable


def test_the_standard_marker_in_numbers() -> None:
    made = marker(load_pattern("ssl-standard"))
    assert made.anchor_area_m2 == pytest.approx(math.pi * 0.025**2)
    assert made.areas_m2 == pytest.approx(np.full((4, 2), math.pi * 0.02**2))
    assert np.hypot(*made.slots_m.T) == pytest.approx(np.full(4, 0.065), abs=1e-5)
    assert sorted(made.codes) == list(range(16))
    assert made.place_values.tolist() == [1, 2, 4, 8]
    assert (made.digits[:, PAINT_TABLE.index("orange")] == NO_DIGIT).all()


def test_a_color_without_a_class_is_named() -> None:
    with pytest.raises(SettingsError, match="magenta") as refused:
        marker(load_pattern("vsss-three-patch"), TABLE)
    assert "orange" in str(refused.value)
