"""``pslv check-client`` finds no fault in the clients that are shipped."""

import json
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.client.test_command import environment
from tests.client.test_other_languages import c_command
from tests.examination.durations import FOR_PROGRAMS, shorten
from tests.examination.test_before_match import free_port
from vision_core.examination.__main__ import main
from vision_core.examination.findings import Grade
from vision_core.examination.trial.examine import ACTS

pytestmark = pytest.mark.slow

FOREVER = "1000000000"
Words = Callable[[str, Path], list[str]]


def python_words(port: str, _built: Path) -> list[str]:
    return [sys.executable, "-m", "vision_core.client", "--team", "blue", "--number", "3", "--port", port]


def c_words(port: str, built: Path) -> list[str]:
    return [*c_command(built), "blue", "3", "127.0.0.1", port, FOREVER]


def test_the_client_of_the_page_survives_a_restart_and_what_is_malformed(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    shorten(monkeypatch, FOR_PROGRAMS)
    port = str(free_port())
    script = str(Path(__file__).parents[2] / "examples" / "stdlib_client.py")
    for act in ("malformed", "restart"):
        words = ["--", sys.executable, script, "blue", "3", "127.0.0.1", port, FOREVER]
        assert main(["check-client", "--port", port, "--only", act, *words]) == Grade.GOOD, capsys.readouterr().out


@pytest.mark.parametrize("words", [python_words, c_words], ids=["python", "c"])
def test_a_client_that_is_shipped_is_a_good_one(
    words: Words, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    shorten(monkeypatch, FOR_PROGRAMS)
    monkeypatch.setenv("PYTHONPATH", environment()["PYTHONPATH"])
    port = str(free_port())
    status = main(["check-client", "--port", port, "--json", "--", *words(port, tmp_path)])
    found = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    assert [one for one in found if one["grade"] != "good"] == []
    assert status == Grade.GOOD
    assert len(found) > len(ACTS)


def test_numpy_is_all_it_needs() -> None:
    done = subprocess.run(
        [sys.executable, "-m", "vision_core.examination", "check-client", "--help"],
        env=environment(), capture_output=True, text=True, check=True,
    )  # fmt: skip
    assert all(act in done.stdout for act in ACTS)
