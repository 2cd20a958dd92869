"""``pslv check``: what a team is told before a match."""

import json
import math
import socket
import subprocess
import sys
from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np
import pytest

from tests.client.fake import ScriptedServer
from tests.client.test_command import ALONE, environment
from tests.net.serving import Stadium, running
from vision_core.client.extras import NO_EXTRAS, Extras
from vision_core.client.view import View
from vision_core.clock import MonotonicClock
from vision_core.examination.__main__ import main
from vision_core.examination.before_match import Asked, check_server
from vision_core.examination.findings import Finding, Grade
from vision_core.examination.measures import Watched, on_lag, on_losses, on_rate, on_sight
from vision_core.protocol.admission import Admission
from vision_core.protocol.error_codes import ErrorCode
from vision_core.protocol.messages import HIDDEN
from vision_core.types.objects import Team

SECONDS = 0.8


@pytest.fixture
def stadium() -> Iterator[Stadium]:
    opened = Stadium()
    opened.send_frame()  # compiles
    yield opened
    opened.close()


def check(port: int, *, host: str = "127.0.0.1", key: str = "", timeout_s: float = 2.0) -> dict[str, Finding]:
    asked = Asked(host, port, Team.BLUE, 3, key)
    return {one.name: one for one in check_server(asked, MonotonicClock(), seconds=SECONDS, timeout_s=timeout_s)}


def test_a_good_server_is_told_in_words(stadium: Stadium) -> None:
    with running(stadium):
        found = check(stadium.port)
    session_port = stadium.session.getsockname()[1]
    assert [found[name].grade for name in ("name", "admission", "port", "mirror", "version", "field")] == [
        Grade.GOOD
    ] * 6
    assert found["port"].sentence == f"views come from port {session_port}"
    assert found["mirror"].sentence == "A 4.0187, B 0.0125935, C 90000; its horizon is at 108.8 px"
    assert found["field"].sentence == "default: 2.8 x 2.3 m between the lines"
    assert "no robot; 360 deg around 180 deg, every 1 deg" in found["views"].sentence
    assert found["sight"].grade is Grade.GOOD
    assert {"rate", "losses", "lag", "clock", "verdict"} < set(found)
    assert not len(stadium.server.sessions) or stadium.serve()  # bye has come


def refusing(error: str) -> dict[str, Finding]:
    with ScriptedServer(lambda _: [b"(error %s)" % error.encode()]) as server:
        return check(server.port, timeout_s=0.3)


@pytest.mark.parametrize(
    ("error", "said"),
    [
        (ErrorCode.NOT_ADMITTED, "The referee finds 127.0.0.1, blue 3, among the Waiting requests"),
        (ErrorCode.WRONG_KEY, "ask the referee"),
        (ErrorCode.ALREADY_CONNECTED, "another program has blue 3"),
        (ErrorCode.ILLEGAL_NUMBER, "the match has no blue 3"),
        (ErrorCode.NOT_READY, "still prepares"),
        (ErrorCode.SERVER_FULL, "no socket left"),
        ("out_of_paint", "error out_of_paint"),
    ],
)
def test_a_refusal_says_who_has_to_do_what(error: str, said: str) -> None:
    found = refusing(error)
    assert set(found) == {"name", "admission", "verdict"}
    assert said in found["admission"].sentence
    assert (found["verdict"].grade, found["verdict"].sentence) == (Grade.BAD, "not ready: admission")


def test_an_address_that_is_not_admitted_is_told_by_a_real_server(stadium: Stadium) -> None:
    admission = Admission.from_texts((), (), ("127.0.0.0/8",))
    stadium.restart(replace(stadium.rules, admission=admission))
    with running(stadium):
        assert "clicks Admit" in check(stadium.port)["admission"].sentence


def test_silence_has_a_reason() -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as deaf:
        deaf.bind(("127.0.0.1", 0))
        found = check(deaf.getsockname()[1], timeout_s=0.2)
        assert "Does a firewall drop UDP?" in found["answer"].sentence
    closed = check(deaf_port := free_port(), timeout_s=0.2)
    assert f"nobody listens at UDP port {deaf_port}" in closed["answer"].sentence
    assert "no computer that is known here" in check(6000, host="no such host")["name"].sentence


def free_port() -> int:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as one:
        one.bind(("127.0.0.1", 0))
        return int(one.getsockname()[1])


def test_a_server_of_version_1_from_one_port_is_doubtful() -> None:
    see = b"(see %d.000 ((edge) %s) ((ball) -1 0 0))"
    answers = iter([[b"(init blue 3 play_on)", b"(mirror 4.0187 0.0125935 90000.0)"]])
    with ScriptedServer(lambda _: next(answers, [see % (1, b"w2c")])) as server:
        found = check(server.port)
    assert (found["version"].grade, found["port"].grade) == (Grade.DOUBTFUL, Grade.DOUBTFUL)
    assert "(port same)" in found["port"].sentence


def test_a_robot_that_is_not_seen_is_not_ready(stadium: Stadium) -> None:
    stadium.blind = True
    with running(stadium):
        found = check(stadium.port)
    assert found["sight"].sentence.startswith("the camera does not see blue 3")
    assert found["verdict"].grade is Grade.BAD


def watched(times_s: list[float], *, age_s: float = 0.01, extras: Sequence[Extras] = ()) -> Watched:
    edges, px, mm = np.array(list("www")), np.zeros(3, dtype=np.int16), np.zeros(3)
    views = [
        View(time_s, edges, px, mm, mm, HIDDEN, math.inf, age_s, 1e-4, own)
        for time_s, own in zip(times_s, extras or [NO_EXTRAS] * len(times_s), strict=True)
    ]
    return Watched(times_s[-1] - times_s[0], views)


GRID = [k / 100 for k in range(1000)]


@pytest.mark.parametrize(
    ("lost", "grade", "said"),
    [
        ([], Grade.GOOD, "0 of 1000 views are missing; the longest gap is 10 ms"),
        ([500], Grade.GOOD, "1 of 1000 views are missing; the longest gap is 20 ms"),
        (range(500, 520), Grade.DOUBTFUL, "20 of 1000 views are missing; the longest gap is 210 ms"),
        (range(100, 160), Grade.BAD, "60 of 1000 views are missing; the longest gap is 610 ms"),
    ],
)
def test_losses_are_counted(lost: list[int], grade: Grade, said: str) -> None:
    finding = on_losses(watched([time for k, time in enumerate(GRID) if k not in lost]), 0.01)
    assert finding.grade is grade
    assert finding.sentence.startswith(said)


def test_views_that_a_match_thins_out_are_not_missing() -> None:
    uneven = [time + (0.004 if k % 3 else 0.0) for k, time in enumerate(GRID)]
    numbers = [Extras(seq=5 * k) for k in range(len(GRID))]
    for one, period_s in ((watched(uneven), None), (watched(uneven, extras=numbers), 0.002)):
        assert on_losses(one, period_s).sentence.startswith("0 of 1000 views are missing")


def test_the_numbers_of_images_count_more_than_their_times() -> None:
    late = [time_s + (0.02 if k == 500 else 0.0) for k, time_s in enumerate(GRID)]
    assert on_losses(watched(late), 0.01).sentence.startswith("2 of 1002 views are missing")
    numbered = [Extras(seq=k) for k in range(len(GRID))]
    assert on_losses(watched(late, extras=numbered), 0.01).sentence.startswith("0 of 1000 views are missing")


def test_rate_and_lag_are_judged() -> None:
    assert on_rate(watched(GRID), 0.01).grade is Grade.GOOD
    assert on_rate(watched(GRID), 0.005).grade is Grade.DOUBTFUL
    assert (
        on_lag(watched(GRID)).sentence == "views are 10.0 ms old when they arrive, 99 of 100 at most 10.0 ms, +- 0.1 ms"
    )
    assert on_lag(watched(GRID, age_s=0.05)).grade is Grade.DOUBTFUL
    assert on_lag(watched(GRID, age_s=math.nan)).grade is Grade.DOUBTFUL
    assert (
        on_sight(watched(GRID, extras=[Extras(flags=frozenset({"nopose"}))] * len(GRID)), "blue 3").grade is Grade.BAD
    )


def test_the_command_prints_and_its_exit_code_is_the_verdict(
    stadium: Stadium, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["check", "--port", str(stadium.port), "--number", "3", "--seconds", str(SECONDS), "--json"]
    with running(stadium):
        status = main(words)
    lines = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    assert lines[-1]["name"] == "verdict"
    assert ("good", "doubtful", "bad")[status] == lines[-1]["grade"]
    assert main(["check", "--port", str(free_port())]) == Grade.BAD
    assert "bad       verdict" in capsys.readouterr().out


def test_numpy_is_all_it_needs() -> None:
    alone = ALONE.replace("vision_core.client.__main__", "vision_core.examination.__main__")
    command = [sys.executable, "-c", alone, "check", "--help"]
    done = subprocess.run(command, env=environment(), capture_output=True, text=True, check=False)
    assert "Connect as a robot" in done.stdout, done.stderr
