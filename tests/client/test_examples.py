"""The examples run against a playing server."""

import math
import re
import subprocess
import sys
from pathlib import Path

import cv2
import pytest

from tests.client.arena import Arena
from tests.client.fake import ScriptedServer
from tests.client.test_command import environment
from tests.net.serving import Stadium, running
from tests.onboard.scenes import Lab, lone_pair
from vision_core.onboard.camera import RATE_HZ, SIZE_PX

EXAMPLES = Path(__file__).parents[2] / "examples"


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("stdlib_client.py", "ahead w at 44 px, ball 61 px at 121 deg"),
        ("color_camera.py", "ball 61 px at 121 deg, nearest obstacle none"),
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


def test_the_monitor_shows_the_field_until_it_has_seen_enough() -> None:
    def answers(datagram: bytes) -> list[bytes]:
        if b"cookie 0123456789abcdef01234567" in datagram:
            return [b"(dispinit play_on (version 2))", *[b"(show 1.0 ((ball) 120 -35 800 0))"] * 2]
        return [b"(challenge 0123456789abcdef01234567)"] if datagram.startswith(b"(dispinit") else []

    with ScriptedServer(answers) as server:
        command = [sys.executable, str(EXAMPLES / "monitor.py"), "127.0.0.1", str(server.port), "2", "K"]
        done = subprocess.run(command, capture_output=True, text=True, timeout=30, env=environment(), check=False)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.count("((ball) 120 -35 800 0)") == 2
    assert server.heard[0] == b"(dispinit (key K))"
    assert server.heard[-1] == b"(bye)"


@pytest.mark.parametrize("name", ["chase_ball.py", "keep_goal.py"])
def test_an_example_that_drives(name: str) -> None:
    arena = Arena()
    with running(arena):
        command = [sys.executable, str(EXAMPLES / name), "yellow", "2", "127.0.0.1", str(arena.port), "5"]
        done = subprocess.run(command, capture_output=True, text=True, timeout=30, env=environment(), check=False)
    arena.close()
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.count("ball at 0.38 m, 121 deg -> ") == 5
    assert len(arena.driven) >= 4  # bye may have come before the last one was heard


def run_stdlib_client(port: int, views: int = 1) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, str(EXAMPLES / "stdlib_client.py"), "blue", "3", "127.0.0.1", str(port), str(views)]
    return subprocess.run(command, capture_output=True, text=True, timeout=30, env=environment(), check=False)


@pytest.mark.slow
def test_without_a_server_it_asks_again_and_says_one_line() -> None:
    with ScriptedServer(lambda _: []) as server:
        done = run_stdlib_client(server.port)
    assert server.heard == [b"(init blue 3)"] * 5
    assert (done.returncode, done.stdout) == (1, "")
    (line,) = done.stderr.splitlines()
    assert line.startswith(f"nothing answers at 127.0.0.1 port {server.port}")


@pytest.mark.slow
@pytest.mark.parametrize("error", ["not_ready", "rate_limited"])
def test_a_server_that_is_not_ready_or_busy_is_asked_again(error: str) -> None:
    refused = b"(error %s)" % error.encode()
    answers = iter([[refused], [refused], [b"(init blue 3 play_on)", b"(see 1.000 ((edge) w2c) ((ball) -1 0 0))"]])
    with ScriptedServer(lambda _: next(answers, [])) as server:
        done = run_stdlib_client(server.port)
    assert (done.returncode, done.stderr) == (0, f"(error {error}): asking again every second\n")
    assert server.heard == [b"(init blue 3)"] * 3 + [b"(bye)"]


@pytest.mark.slow
def test_a_robot_that_the_camera_does_not_see_is_one_line_and_it_waits_for_views() -> None:
    granted, see = b"(init blue 3 play_on)", b"(see 1.000 ((edge) w2c) ((ball) -1 0 0))"
    answers = iter([[granted]] * 6 + [[granted, see]])
    with ScriptedServer(lambda _: next(answers, [])) as server:
        done = run_stdlib_client(server.port)
    assert done.returncode == 0
    (line,) = done.stderr.splitlines()
    assert line.startswith("no view for 5 s: the camera does not see the robot")
    assert server.heard == [b"(init blue 3)"] * 7 + [b"(bye)"]


@pytest.mark.parametrize("lost", [0, 1])
def test_late_answers_are_passed_over_and_an_end_is_said(lost: int) -> None:
    granted, see = b"(init blue 3 play_on)", b"(see 1.000 ((edge) w2c) ((ball) -1 0 0))"
    silence: list[list[bytes]] = [[]] * lost
    answers = iter([*silence, [granted, granted, see, see, b"(error replaced)"]])
    with ScriptedServer(lambda _: next(answers, [])) as server:
        done = run_stdlib_client(server.port, views=3)
    assert done.stdout.count("1.000 s: ahead w at 44 px, ball hidden") == 2
    assert (done.returncode, done.stderr) == (1, "(error replaced)\n")
    assert server.heard == [b"(init blue 3)"] * (lost + 1) + [b"(bye)"]


@pytest.mark.slow
def test_the_color_program_runs_on_a_rendered_cameras_video_unchanged(tmp_path: Path) -> None:
    lab, video = Lab(lone_pair()), tmp_path / "onboard.avi"
    scene = lab.scene((0.0, 0.0, 0.0), (0.5, 0.5, 0.0), ball=(0.4, 0.0))
    writer = cv2.VideoWriter(str(video), cv2.VideoWriter.fourcc(*"MJPG"), RATE_HZ, SIZE_PX)
    for _ in range(2):
        writer.write(lab.camera.picture(scene))
    writer.release()
    command = [sys.executable, str(EXAMPLES / "color_camera.py"), str(video)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=30, env=environment(), check=False)
    assert (done.returncode, done.stderr) == (0, "")
    lines = done.stdout.splitlines()
    assert len(lines) == 2
    found = re.fullmatch(r"ball (\d+) px at (\d+) deg, nearest obstacle (\d+) px at (\d+) deg", lines[0])
    assert found is not None
    ball_px, ball_deg, robot_px, robot_deg = map(int, found.groups())
    assert ball_px == pytest.approx(lab.px_of(400.0), abs=4)  # its middle is seen over the floor behind it
    assert (ball_deg + 180) % 360 - 180 == pytest.approx(0, abs=2)
    assert robot_px == pytest.approx(lab.px_of(1000.0 * math.hypot(0.5, 0.5) - 90.0), abs=3)
    assert robot_deg == pytest.approx(45, abs=6)
