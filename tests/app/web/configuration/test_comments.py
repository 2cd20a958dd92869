"""What the shipped settings file says about each setting is found beside its key."""

from msgspec import to_builtins

from app.web.configuration.comments import comments
from app.web.configuration.configuration import flat
from vision_core.venues.loader import load_settings

SELF_EVIDENT = {"name", "a", "b", "c", "color", "radius_m"}
"""Keys that are left without words where their table has some."""


def test_a_comment_stands_beside_its_key() -> None:
    assert comments()["match.blue_defends"] == "left: the goal at negative x"


def test_a_comment_goes_on_in_the_next_lines() -> None:
    assert comments()["robots.pattern"].endswith("[robots.blue] or [robots.yellow] with a pattern of its own")


def test_a_table_has_its_own() -> None:
    assert comments()["synthetic"] == "the simulated ceiling camera"


def test_no_comment_is_about_a_key_that_does_not_exist() -> None:
    settings = flat(to_builtins(load_settings()))
    tables = {key.rpartition(".")[0] for key in settings}
    unknown = set(comments()) - settings.keys() - tables - {"colors.classes.green", "colors.samples"}
    assert not unknown
