"""Which robots clients may drive, from the settings."""

import pytest

from vision_core.protocol.driving import DriveLimits
from vision_core.tasks.session_rules import drives_of
from vision_core.types.objects import Team
from vision_core.venues.loader import load_settings


def test_the_robots_of_a_simulated_match_can_be_driven() -> None:
    drives = drives_of(load_settings(options={"synthetic.robots_per_team": 2}))
    assert drives == dict.fromkeys(
        [(team, number) for team in Team for number in (1, 2)], DriveLimits(2.0, 2.0, 10.0, 5.0, dribbler=True)
    )


@pytest.mark.parametrize("preset", ["vsss", "vsss-5x5", "mirosot-middle"])
def test_robots_on_two_wheels_have_nothing_but_wheels(preset: str) -> None:
    limits = drives_of(load_settings(options={"field_preset": preset}))[Team.YELLOW, 1]
    assert (limits.vy_m_s, limits.kick_m_s, limits.dribbler) == (0.0, 0.0, False)
    assert limits.vx_m_s > 0.0


@pytest.mark.parametrize("uri", ["camera:0", "file:/there/is/none.avi"])
def test_no_robot_of_a_camera_or_a_recording_can_be_driven(uri: str) -> None:
    assert drives_of(load_settings(options={"source.uri": uri})) == {}
