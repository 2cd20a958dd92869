"""``pslv play``: a short match of one against one, and what is wrong in words."""

from collections.abc import Iterator
from pathlib import Path
from xml.etree import ElementTree as ET

import pytest
from typer.testing import CliRunner

from app.cli import app
from tests.client.arena import Arena
from tests.client.play.service_page import served
from tests.net.serving import playing
from vision_core.errors import PslvError


@pytest.fixture
def arena() -> Iterator[Arena]:
    with playing(Arena()) as opened:
        yield opened


def test_a_match_is_played_told_and_drawn(arena: Arena, tmp_path: Path) -> None:
    picture = tmp_path / "match.svg"
    with served() as page:
        words = ["--robots", "2", "--minutes", "0.05", "--port", str(arena.port), "--page", page, "--out", str(picture)]
        done = CliRunner().invoke(app, ["play", *words])
    assert done.exit_code == 0, done.output
    told = " ".join(done.output.split())
    assert "chase against chase, 2 each" in told
    assert all(f"{team} {number}" in told for team in ("blue", "yellow") for number in (1, 2))
    assert "possession 25 % : 75 %" in told
    assert {(event.session.team, event.session.number) for event in arena.driven} == {
        ("blue", 1), ("blue", 2), ("yellow", 1), ("yellow", 2),
    }  # fmt: skip
    assert ET.parse(picture).getroot().tag.endswith("svg")


@pytest.mark.parametrize(
    ("words", "reason"),
    [
        (["--controller", "no_such:Team"], "controller no_such:Team; found: No module named 'no_such'"),
        (["--port", "9", "--robots", "1"], "nothing answered at 127.0.0.1:9"),
        (["--out", "no-such-folder/match.svg"], "picture no-such-folder/match.svg; found: no-such-folder is no folder"),
        (["--out", "."], r"picture \.; found: it is a folder"),
    ],
)
def test_what_is_wrong_is_said(words: list[str], reason: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("vision_core.client.play.players.TIMEOUT_S", 0.5)
    with pytest.raises(PslvError, match=reason):
        CliRunner().invoke(app, ["play", *words], catch_exceptions=False)
