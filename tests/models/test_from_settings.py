"""Which robots a team has."""

from pathlib import Path

from vision_core.models.from_settings import robots_of
from vision_core.types.objects import Team
from vision_core.venues.loader import load_settings


def test_a_pattern_says_how_large_its_robots_are_and_a_venue_may_change_it(tmp_path: Path) -> None:
    venue = tmp_path / "venue.toml"
    venue.write_text('[robots]\nheight_m = 0.15\n[robots.yellow]\npattern = "ssl-standard"\nradius_m = 0.08\n')
    robots = load_settings(str(venue)).robots
    blue, yellow = robots_of(robots, Team.BLUE), robots_of(robots, Team.YELLOW)
    assert (blue.outline, blue.radius_m, blue.height_m) == ("circle", 0.09, 0.15)
    assert (yellow.outline, yellow.radius_m, yellow.height_m) == ("circle", 0.08, 0.14)
