"""What is derived from a pattern: areas, codes, and how many patches tell the heading."""

import math

import msgspec
import numpy as np
import pytest

from tests.objects.drawing import PAINT_TABLE, SETTINGS, TABLE
from tests.objects.finding import SHIPPED
from vision_core.errors import SettingsError
from vision_core.objects.robots.markers import ANCHOR, REFUSED, Marker, marker_of
from vision_core.patterns.loader import Patch, Pattern, load_pattern
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
    ("name", "enough", "shaped"),
    [("ssl-standard", 3, 3), ("vsss-three-patch", 2, 1), ("vsss-diagonal", 1, 1), ("mirosot-quarters", 2, 2)],
)
def test_so_many_patches_tell_the_heading(name: str, enough: int, shaped: int) -> None:
    made = marker(load_pattern(name))
    assert (made.enough, made.enough_shaped) == (enough, shaped)


@pytest.mark.parametrize("name", ["t-plate", "mirosot-diagonal", "vsss-corner-patch"])
def test_some_team_patches_tell_it_alone(name: str) -> None:
    assert marker(load_pattern(name)).enough_shaped == 0


def test_a_marker_that_repeats_never_tells() -> None:
    """Two dots of one class, on both sides of the center: half a turn changes nothing."""
    ssl = load_pattern("ssl-standard")
    sides = tuple(Patch(color="pink", circle_mm=(0.0, y, 40.0)) for y in (50.0, -50.0))
    made = marker(msgspec.structs.replace(ssl, patches=(ssl.patches[0], *sides)))
    assert made.enough == 3 > len(made.slots_m)


@pytest.mark.parametrize("name", SHIPPED)
def test_patches_are_as_drawn(name: str) -> None:
    pattern = load_pattern(name)
    made = marker(pattern)
    assert made.shares.sum() == pytest.approx(1.0)
    assert len(made.slots_m) == len(made.digits) == len(pattern.patches) - 1
    assert sorted(made.ids) == sorted(pattern.code_by_id)
    assert len(set(made.codes.tolist())) == len(made.codes)
    assert made.wears[PAINT_TABLE.index("blue")] & ANCHOR
    assert made.slots_m - made.anchor_m == pytest.approx(made.arms_m)
    assert not made.slots_m.flags.writeable


def test_the_standard_marker_in_numbers() -> None:
    made = marker(load_pattern("ssl-standard"))
    assert made.anchor_area_m2 == pytest.approx(math.pi * 0.025**2)
    assert made.areas_m2 == pytest.approx(np.full(4, math.pi * 0.02**2))
    assert np.hypot(*made.slots_m.T) == pytest.approx(np.full(4, 0.065), abs=1e-5)
    assert sorted(made.codes) == list(range(16))
    assert made.places.tolist() == [1, 2, 4, 8]
    assert (made.digits[:, PAINT_TABLE.index("orange")] == REFUSED).all()


def test_a_color_without_a_class_is_named() -> None:
    with pytest.raises(SettingsError, match="magenta") as refused:
        marker(load_pattern("vsss-three-patch"), TABLE)
    assert "orange" in str(refused.value)
