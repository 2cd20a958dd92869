"""In which line a setting stands."""

from vision_core.venues.toml_lines import line_of

TEXT = """# a venue
name = "x"
camera.rate_hz = 30.0

[tasks]
lines = { period_ms = 400.0 }

[tasks.obstacles]    # slower
priority = 3
period_ms = 100.0

["odd name".inner]
list = [
  1,
]
"""


def test_a_key_is_found_in_its_table() -> None:
    assert line_of(TEXT, ["tasks", "obstacles", "period_ms"]) == 10
    assert line_of(TEXT, ["camera", "rate_hz"]) == 3
    assert line_of(TEXT, ["name"]) == 2
    assert line_of(TEXT, ["odd name", "inner", "list", "0"]) == 13


def test_of_what_stands_in_one_value_the_value_is_told() -> None:
    assert line_of(TEXT, ["tasks", "lines", "period_ms"]) == 6


def test_the_nearest_parent_is_told() -> None:
    assert line_of(TEXT, ["tasks", "obstacles", "cores"]) == 8
    assert line_of(TEXT, ["tasks", "capture", "priority"]) == 5


def test_what_is_not_there_has_no_line() -> None:
    assert line_of(TEXT, ["colors", "space"]) is None
