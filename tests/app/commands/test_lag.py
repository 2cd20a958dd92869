"""``pslv lag``: every view's lags as a table, as JSON and as the paper's figure 8; a server that tells none."""

import json
from collections.abc import Iterator
from pathlib import Path

import pytest
from typer.testing import CliRunner

from app.cli import app
from tests.net.serving import Stadium, playing
from vision_core.errors import PslvError
from vision_core.native.opencv import read_picture


@pytest.fixture
def stadium() -> Iterator[Stadium]:
    with playing(Stadium()) as made:
        yield made


def asked(stadium: Stadium, *options: str) -> list[str]:
    return [
        "lag",
        "127.0.0.1",
        "--port",
        str(stadium.port),
        "--team",
        "blue",
        "--number",
        "2",
        "--seconds",
        "1",
        *options,
    ]


def test_the_lags_of_a_second(stadium: Stadium, tmp_path: Path) -> None:
    picture = tmp_path / "lag.png"
    done = CliRunner().invoke(app, asked(stadium, "--json", "--picture", str(picture)), catch_exceptions=False)
    rows = [json.loads(line) for line in done.output.splitlines()]
    assert len(rows) > 10
    for row in rows:
        assert row["total_ms"] == pytest.approx(row["a_ms"] + row["b_ms"] + row["c_ms"])
        assert row["a_ms"] >= 0.0
        assert row["c_ms"] > 0.0
    assert read_picture(picture).shape == (420, 960, 3)


def test_a_table_for_people(stadium: Stadium) -> None:
    done = CliRunner().invoke(app, asked(stadium), catch_exceptions=False)
    assert done.output.lstrip().startswith("lag [ms]")
    assert [line.split()[0] for line in done.output.splitlines()[1:5]] == ["A", "B", "C", "total"]
    assert "B is right within" in done.output


def test_a_robot_that_is_not_seen_has_no_lags(stadium: Stadium, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("app.commands.lag.PATIENCE_S", 0.2)
    stadium.blind = True
    with pytest.raises(PslvError, match="a robot that the camera sees"):
        CliRunner().invoke(app, asked(stadium), catch_exceptions=False)
