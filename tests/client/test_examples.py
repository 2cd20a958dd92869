"""The examples run against a playing server."""

import subprocess
import sys
from pathlib import Path

import pytest

from tests.client.test_command import environment
from tests.net.serving import Stadium, running

EXAMPLES = Path(__file__).parents[2] / "examples"


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("stdlib_client.py", "ahead w at 44 px, ball 61 px at 121 deg"),
        ("chase_ball.py", "something 133 mm before us: drive around it"),
    ],
)
def test_an_example(name: str, expected: str) -> None:
    stadium = Stadium()
    with running(stadium):
        command = [sys.executable, str(EXAMPLES / name), "yellow", "2", "127.0.0.1", str(stadium.port), "5"]
        done = subprocess.run(command, capture_output=True, text=True, timeout=30, env=environment(), check=False)
    stadium.close()
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.count(expected) == 5
