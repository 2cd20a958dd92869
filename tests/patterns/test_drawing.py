"""Markers as pictures: every shipped one is drawn with all of its patches."""

from xml.etree import ElementTree as ET

import pytest

from vision_core.patterns.drawing import marker_svg
from vision_core.patterns.loader import load_pattern
from vision_core.types.objects import Team
from vision_core.venues.presets import shipped


@pytest.mark.parametrize("name", shipped("patterns"))
def test_every_patch_is_drawn(name: str) -> None:
    pattern = load_pattern(name)
    for team in Team:
        for number in pattern.code_by_id:
            drawn = ET.fromstring(marker_svg(pattern, team, number))
            assert len(drawn) == len(pattern.patches) + 2, "the robot, its patches, and the arrow"
    colors = {marker_svg(pattern, Team.BLUE, number) for number in pattern.code_by_id}
    assert len(colors) == len(pattern.code_by_id)
    with pytest.raises(KeyError):
        marker_svg(pattern, Team.BLUE, 255)
