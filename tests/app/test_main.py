"""The entry point without the server's libraries: teams' commands work, the others name what is missing."""

import sys

import pytest

from app import main as entry


@pytest.mark.parametrize("command", ["client", *entry.EXAMINATIONS])
def test_commands_of_teams_need_numpy_only(
    command: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(entry, "find_spec", lambda _: None)
    monkeypatch.setattr(sys, "argv", ["pslv", command, "--help"])
    with pytest.raises(SystemExit) as left:
        entry.main()
    assert left.value.code == 0
    assert f"usage: pslv {command}" in capsys.readouterr().out


def test_other_commands_name_what_is_missing(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(entry, "find_spec", lambda _: None)
    monkeypatch.setattr(sys, "argv", ["pslv", "top"])
    with pytest.raises(SystemExit) as left:
        entry.main()
    assert left.value.code == 2
    assert "pip install 'pslv[server]'" in capsys.readouterr().err
