"""A team's name in addresses."""

import pytest

from app.web.configuration.teams import slug_of


@pytest.mark.parametrize(
    ("name", "slug"), [("1. FC Köln", "1-fc-koln"), ("CGN", "cgn"), ("--x--", "x"), ("日本", ""), ("a/../b", "a-b")]
)
def test_a_name_in_addresses(name: str, slug: str) -> None:
    assert slug_of(name) == slug
