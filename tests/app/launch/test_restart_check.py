"""What a restart of the service would fail of is found before anything is stopped."""

from pathlib import Path

import msgspec
import pytest

from app.launch import restart_check
from app.launch.prepared import StartOptions, prepare
from app.launch.restart_check import Running, check, check_command
from vision_core.errors import PslvError


@pytest.fixture
def config(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A file of settings that a service was started with; the stages' own check is left out."""
    monkeypatch.setattr(restart_check, "try_settings", lambda *_args, **_options: [])
    monkeypatch.setattr(restart_check, "compile_kernels", lambda *_args, **_options: None)
    path = tmp_path / "hall.toml"
    path.write_text("")
    return path


def running(config: Path, options: dict[str, str | int | None] | None = None) -> Running:
    start = StartOptions(config=str(config), database=str(config.parent), options=options or {})
    settings = prepare(start, print).settings
    return Running(start, settings.server, settings.source.uri)


def test_what_did_not_change_can_start_again(config: Path) -> None:
    check(running(config))


def test_an_address_cannot_change(config: Path) -> None:
    before = running(config)
    config.write_text('[server]\nhost = "127.0.0.2"\n')
    with pytest.raises(PslvError, match=r"server.host; found: 127.0.0.2; accepted: 127.0.0.1 as long as"):
        check(before)
    config.write_text("[server]\nudp_port = 7000\n")
    with pytest.raises(PslvError, match=r"server.udp_port; found: 7000"):
        check(before)


def test_an_address_of_the_command_line_comes_first(config: Path) -> None:
    before = running(config, {"server.udp_port": 6500})
    config.write_text("[server]\nudp_port = 7000\n")
    check(before)


def test_a_mistake_in_the_file_is_named_with_file_and_key(config: Path) -> None:
    before = running(config)
    config.write_text("[protocol]\nlease_s = -1.0\n")
    with pytest.raises(PslvError, match=r"hall.toml.*lease_s"):
        check(before)


def test_how_the_service_was_started_survives_the_command(config: Path) -> None:
    before = running(config, {"server.udp_port": 6500, "source.uri": None})
    *_, text = check_command(before)
    assert msgspec.json.decode(text, type=Running) == before
