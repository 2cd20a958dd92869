"""The command: what it prints, draws and answers; and that numpy is all it needs."""

import json
import os
import re
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from tests.client.fake import ScriptedServer
from tests.net.serving import Stadium, playing
from vision_core.client import __main__ as command_module
from vision_core.client.__main__ import main
from vision_core.client.panorama import draw_panorama
from vision_core.models.mirror import PAPER_MIRROR

ROOT = Path(__file__).parents[2]
ALONE = """
import sys
import importlib.abc

class Nothing(importlib.abc.MetaPathFinder):
    def find_spec(self, name, path=None, target=None):
        top = name.partition(".")[0]
        if path is None and top not in sys.stdlib_module_names and top not in {"numpy", "vision_core"}:
            raise ModuleNotFoundError(f"the client may not need {name}", name=name)

sys.meta_path.insert(0, Nothing())
from vision_core.client.__main__ import main
from vision_core.client.panorama import draw_panorama
from vision_core.models.mirror import PAPER_MIRROR
sys.exit(main())
"""


@pytest.fixture(scope="module")
def stadium() -> Iterator[Stadium]:
    with playing(Stadium()) as opened:
        yield opened


def arguments(stadium: Stadium, *more: str) -> list[str]:
    return ["--team", "blue", "--number", "3", "--port", str(stadium.port), *more]


def environment() -> dict[str, str]:
    return {**os.environ, "PYTHONPATH": str(ROOT), "PYTHONDONTWRITEBYTECODE": "1"}


def test_json_lines(stadium: Stadium, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(arguments(stadium, "--count", "3", "--json")) == 0
    views = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    assert len(views) == 3
    assert set(views[0]) == {"time_s", "edges", "ball", "age_s", "age_bound_s"}
    assert (views[0]["age_s"], views[0]["age_bound_s"]) == (None, None)  # the clock takes some answers
    assert views[0]["edges"] == [["w", 0x2C]] * 360
    assert views[0]["ball"] == {"px": 61, "direction_deg": 121, "size_deg": 6, "hidden": False}
    assert views[0]["time_s"] < views[1]["time_s"] < views[2]["time_s"]


def test_sentences_for_people(stadium: Stadium, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(arguments(stadium, "--count", "1", "--rate", "50")) == 0
    assert "nearest w at 0.22 m, 0 deg, ball at 0.38 m, 121 deg" in capsys.readouterr().out


@pytest.mark.parametrize("more", [[], ["--mirror", "1.933098", "0.00296946", "360000"]])
def test_a_picture(stadium: Stadium, tmp_path: Path, more: list[str]) -> None:
    picture = tmp_path / "view.png"
    assert main(arguments(stadium, "--count", "1", "--draw", str(picture), *more)) == 0
    assert picture.read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize(
    ("more", "complaint"),
    [
        (["--number", "6"], "illegal_number"),
        (["--mirror", "1", "0", "1"], "a mirror of equation 1"),
        (["--count", "1", "--draw", "/no/such/folder/view.png"], "/no/such/folder"),
        (["--port", "1", "--timeout", "0.1"], "nothing answered at 127.0.0.1:1"),
        (["--field-mirror", "1", "0", "1"], "a mirror of equation 1"),
    ],
)
def test_what_goes_wrong_is_one_line_and_exit_2(
    stadium: Stadium, capsys: pytest.CaptureFixture[str], more: list[str], complaint: str
) -> None:
    assert main(arguments(stadium, *more)) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("pslv client: ")
    assert complaint in line


@pytest.mark.parametrize("as_json", [True, False])
def test_an_own_camera_beside_the_views(
    stadium: Stadium, tmp_path: Path, capsys: pytest.CaptureFixture[str], as_json: bool
) -> None:
    seen = np.ascontiguousarray(draw_panorama(np.full(360, 46.0), "w" * 360, (61, 121, 6), PAPER_MIRROR)[..., ::-1])
    picture = tmp_path / "both.png"
    more = ["--camera", "pictures", "--palette", "drawn", "--draw", str(picture), *(["--json"] if as_json else [])]
    assert main(arguments(stadium, *more), lambda _: iter([seen, seen])) == 0
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) == 2
    if as_json:
        camera = json.loads(lines[0])["camera"]
        assert (camera["same_type"], camera["median_px"], camera["ball_px"]) == (1.0, 2.0, 0.0)
        assert camera["edges"][0] == ["w", 46]
    else:
        assert "100.0 % of directions of the same type, distance off by 2.0 px (median)" in lines[0]
    assert picture.read_bytes().startswith(b"\x89PNG")


def test_an_own_camera_needs_a_reader_of_pictures_and_pictures(
    stadium: Stadium, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(arguments(stadium, "--camera", "a.png")) == 2
    assert "the command pslv client" in capsys.readouterr().err
    dark = np.zeros((240, 320, 3), dtype=np.uint8)
    assert main(arguments(stadium, "--camera", "a.png"), lambda _: iter([dark])) == 2
    assert "dark all over" in capsys.readouterr().err
    assert main(arguments(stadium, "--camera", "a.png", "--scale", "-1"), lambda _: iter([dark])) == 2
    assert "--scale" in capsys.readouterr().err


def test_numpy_and_the_standard_library_are_enough(stadium: Stadium, tmp_path: Path) -> None:
    picture = tmp_path / "view.png"
    command = [sys.executable, "-c", ALONE, *arguments(stadium, "--count", "2", "--json", "--draw", str(picture))]
    done = subprocess.run(
        command, capture_output=True, text=True, timeout=30, env=environment(), cwd=tmp_path, check=False
    )
    assert (done.returncode, done.stderr) == (0, "")
    assert len(done.stdout.splitlines()) == 2
    assert picture.stat().st_size > 1000


HEEDING_CTRL_C = (  # a shell that runs the tests in the background has its children ignore it
    "import signal, sys; signal.signal(signal.SIGINT, signal.default_int_handler);"
    "from vision_core.client.__main__ import main; sys.exit(main())"
)


def test_ctrl_c_is_a_clean_end(stadium: Stadium, tmp_path: Path) -> None:
    picture = tmp_path / "view.png"
    command = [sys.executable, "-c", HEEDING_CTRL_C, *arguments(stadium, "--draw", str(picture))]
    with subprocess.Popen(
        command,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env=environment(),
    ) as client:
        assert client.stdout is not None
        assert "nearest" in client.stdout.readline()
        client.send_signal(signal.SIGINT)
        _, complaints = client.communicate(timeout=30)
    assert (client.returncode, complaints) == (0, "")
    assert picture.exists()


def test_a_reader_who_has_seen_enough(stadium: Stadium) -> None:
    command = [sys.executable, "-m", "vision_core.client", *arguments(stadium)]
    with subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=environment()
    ) as client:
        assert client.stdout is not None
        client.stdout.readline()
        client.stdout.close()
        assert client.wait(timeout=30) == 0
        assert client.stderr is not None
        assert client.stderr.read() == ""


def test_once_the_clock_is_known_the_lag_is_said(stadium: Stadium, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(arguments(stadium, "--count", "40")) == 0
    first, *_, last = capsys.readouterr().out.splitlines()
    assert "lag" not in first
    assert re.search(r"\d s, lag -?\d+\.\d \+- \d+\.\d ms, nearest", last)
    assert main(arguments(stadium, "--count", "40", "--json")) == 0
    told = json.loads(capsys.readouterr().out.splitlines()[-1])
    assert abs(told["age_s"]) < 10.0
    assert told["age_bound_s"] > 0.0


def granting(*then: bytes) -> ScriptedServer:
    """A server that answers every init, and its question for the mirror, and says more at once."""
    answers = [b"(init blue 3 play_on)", b"(mirror 4.0187 0.0125935 90000.0)", *then]
    return ScriptedServer(lambda data: answers if data.startswith(b"(init") else [])


def test_a_robot_that_the_camera_does_not_see_is_waited_for_so_long(capsys: pytest.CaptureFixture[str]) -> None:
    with granting() as server:
        assert main(["--team=blue", "--number=3", f"--port={server.port}", "--count=1", "--timeout=0.3"]) == 2
    said = f"connected as blue 3 from port {server.port}, but the camera does not see it; no view within 0.3 s"
    assert said in capsys.readouterr().err


def test_while_it_waits_it_says_what_for(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(command_module, "STALE_S", 0.1)
    with granting() as server:
        assert main(["--team=blue", "--number=3", f"--port={server.port}", "--timeout=0.25"]) == 2
    lines = capsys.readouterr().err.splitlines()
    assert len(lines) == 3
    assert all("connected as blue 3" in line for line in lines)
    assert ["no view within" in line for line in lines] == [False, False, True]


def test_a_server_that_died_is_told_from_a_robot_that_is_not_seen(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(command_module, "RESTART_S", 0.2)
    answers = iter([[b"(init blue 3 play_on)", b"(mirror 4.0187 0.0125935 90000.0)"]])
    with ScriptedServer(lambda _: next(answers, [])) as server:
        assert main(["--team=blue", "--number=3", f"--port={server.port}", "--timeout=0.3"]) == 2
    assert "the server has not answered" in capsys.readouterr().err


def test_another_fields_mirror_is_asked_for(capsys: pytest.CaptureFixture[str]) -> None:
    """112 px are 0.93 m in the mirror of division B, and above the horizon of the paper's."""
    see = b"(see 1.000 ((edge) w70) ((ball) 112 0 1))"
    answers = [b"(init blue 3 play_on)", b"(mirror 1.933098 0.00296946 360000)", see]
    with ScriptedServer(lambda data: answers if data.startswith(b"(init") else []) as server:
        assert main(["--team=blue", "--number=3", f"--port={server.port}", "--count=1"]) == 0
    assert "nearest w at 0.93 m, 0 deg, ball at 0.93 m, 0 deg" in capsys.readouterr().out


def test_a_server_that_does_not_tell_its_mirror_is_one_line(capsys: pytest.CaptureFixture[str]) -> None:
    unknown, see = b"(error unknown_command)", b"(see 1.000 ((edge) w2c) ((ball) -1 0 0))"

    def answer(data: bytes) -> list[bytes]:
        return [b"(init blue 3 play_on)", *[unknown] * data.endswith(b"(mirror)"), see] * data.startswith(b"(init")

    with ScriptedServer(answer) as server:
        robot = ["--team=blue", "--number=3", f"--port={server.port}", "--count=1"]
        assert main(robot) == 2
        (line,) = capsys.readouterr().err.splitlines()
        assert "does not tell its mirror" in line
        assert main([*robot, "--field-mirror", "1.933098", "0.00296946", "360000"]) == 0


def test_a_server_that_prepares_is_waited_for_in_one_line(capsys: pytest.CaptureFixture[str]) -> None:
    granted = [
        b"(init blue 3 play_on)",
        b"(mirror 4.0187 0.0125935 90000.0)",
        b"(see 1.000 ((edge) w2c) ((ball) -1 0 0))",
    ]
    answers = iter([[b"(error not_ready)"]] * 2)
    with ScriptedServer(lambda data: next(answers, granted if data.startswith(b"(init") else [])) as server:
        assert main(["--team=blue", "--number=3", f"--port={server.port}", "--count=1", "--timeout=0.8"]) == 0
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("pslv client: blue 3 at 127.0.0.1:")
    assert "the server still prepares" in line


def test_the_fields_mirror_is_for_decoding_alone(stadium: Stadium, capsys: pytest.CaptureFixture[str]) -> None:
    """44 px through the mirror of division B are another distance, and the server is not asked for anything."""
    mirror = ["1.933098", "0.00296946", "360000"]
    assert main(arguments(stadium, "--count", "1", "--field-mirror", *mirror)) == 0
    assert "nearest w at 0.30 m" in capsys.readouterr().out
    see = b"(see 1.000 ((edge) w2c) ((ball) -1 0 0))"
    with granting(see) as server:
        robot = ["--team=blue", "--number=3", f"--port={server.port}", "--count=1"]
        assert main([*robot, "--field-mirror", *mirror]) == 0
    assert server.heard[0] == b"(init blue 3 (version 2))"


@pytest.mark.parametrize("given", [["--key", "Key_9"], []])
def test_the_teams_key_goes_with_the_init(given: list[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PSLV_KEY", "" if given else "Key_9")
    see = b"(see 1.000 ((edge) w2c) ((ball) -1 0 0))"
    with granting(see) as server:
        assert main(["--team=blue", "--number=3", f"--port={server.port}", "--count=1", *given]) == 0
    assert server.heard[0] == b"(init blue 3 (version 2) (key Key_9))(mirror)"


def test_the_port_is_that_of_the_servers_variable(
    stadium: Stadium, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PSLV_UDP_PORT", str(stadium.port))
    monkeypatch.setenv("PSLV_HOST", "0.0.0.0")  # where a server listens is no address to send to
    assert main(["--team", "blue", "--number", "3", "--count", "1"]) == 0
    assert "nearest w" in capsys.readouterr().out
    monkeypatch.setenv("PSLV_UDP_PORT", "0")
    with pytest.raises(SystemExit):
        main(["--team", "blue", "--number", "3"])
    assert "argument --port: 0 is not within 1..65535" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("option", "values"),
    [
        ("--timeout", ["nan", "inf", "0", "-1", "soon"]),
        ("--rate", ["0", "1001", "fast"]),
        ("--number", ["0", "17", "x"]),
        ("--port", ["0", "65536", "-1"]),
        ("--count", ["0", "-1"]),
    ],
)
def test_a_value_out_of_its_range_is_refused(
    stadium: Stadium, capsys: pytest.CaptureFixture[str], option: str, values: list[str]
) -> None:
    for value in values:
        with pytest.raises(SystemExit) as ended:
            main(arguments(stadium, f"{option}={value}"))
        assert ended.value.code == 2
        assert f"argument {option}: " in capsys.readouterr().err


@pytest.mark.parametrize("word", ["PSLV_UDP_PORT", "first view", "1..1000", "1..16", "config/fields"])
def test_help_tells(capsys: pytest.CaptureFixture[str], word: str) -> None:
    with pytest.raises(SystemExit) as ended:
        main(["--help"])
    assert ended.value.code == 0
    assert word in " ".join(capsys.readouterr().out.split())
