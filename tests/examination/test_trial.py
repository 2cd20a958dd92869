"""``pslv check-client``: each finding has a client that is wrong in this way, and a good client has none."""

from collections.abc import Iterator
from dataclasses import replace

import pytest

from tests.examination.durations import FOR_ROBOTS, shorten
from tests.examination.wrong_clients import Habits, Robot
from vision_core.clock import MonotonicClock
from vision_core.errors import ServiceError
from vision_core.examination.__main__ import main
from vision_core.examination.findings import Finding, Grade
from vision_core.examination.trial.examine import examine_client
from vision_core.examination.trial.program import Program
from vision_core.examination.trial.server import TrialServer

pytestmark = pytest.mark.slow

GOOD_1, GOOD_2 = Habits(), Habits(init=b"(init blue 3 (version 2))")


@pytest.fixture(autouse=True)
def short(monkeypatch: pytest.MonkeyPatch) -> None:
    shorten(monkeypatch, FOR_ROBOTS)


@pytest.fixture
def server() -> Iterator[TrialServer]:
    opened = TrialServer("127.0.0.1", 0, Program(()), MonotonicClock())
    yield opened
    opened.close()


def examine(server: TrialServer, habits: Habits, *acts: str) -> dict[str, Finding]:
    with Robot(server.port, habits):
        found = {finding.name: finding for finding in examine_client(server, acts, wait_s=2.0)}
        del found["verdict"]
        return found


@pytest.mark.parametrize("habits", [GOOD_1, GOOD_2], ids=["version 1", "version 2"])
def test_a_good_client_has_no_faults(habits: Habits, server: TrialServer) -> None:
    found = examine(server, habits)
    assert [finding for finding in found.values() if finding.grade is not Grade.GOOD] == []
    names = {
        "init",
        "not ready",
        "opening",
        "losses",
        "unseen",
        "silence",
        "malformed",
        "mirror",
        "restart",
        "replaced",
    }
    assert set(found) == names | ({"ping", "lease"} if habits is GOOD_2 else set())


WRONG = {
    "repeats too fast": (["late-answers"], replace(GOOD_1, period_s=0.05), "init", "it repeats its init every 0.0"),
    "does not repeat": (
        ["late-answers"],
        replace(GOOD_1, repeats=False),
        "init",
        "it does not repeat its init: 0 came",
    ),
    "makes a mistake": (["late-answers"], Habits(init=b"(init red 3)"), "init", "answered with (error illegal_team)"),
    "gives up": (["late-answers"], replace(GOOD_1, ends_with=b"(error not_ready"), "not ready", "did not ask again"),
    "keeps the cookie": (["opening"], replace(GOOD_2, returns_cookie=False), "opening", "does not return the cookie"),
    "is connected": (["opening"], replace(GOOD_1, connects_to_main=True), "port", "is its socket connected"),
    "runs away": (["opening"], replace(GOOD_1, ends_with=b"(see"), "views", "went away although all was well"),
    "has no patience": (["silences"], replace(GOOD_1, ends_of_silence=True), "unseen", "went away when the camera"),
    "breaks": (
        ["malformed"],
        replace(GOOD_2, ends_with=b"(warning"),
        "malformed",
        "went away after (warning of_a_later",
    ),
    "answers servers": (["malformed"], replace(GOOD_2, answers=b"(error what)"), "malformed", "with (error what)"),
    "forgets the mirror": (["mirror"], replace(GOOD_1, asks_mirror=False), "mirror", "does not ask for the mirror"),
    "breaks at hear": (["mirror"], replace(GOOD_2, ends_with=b"(hear"), "mirror", "went away when the mirror changed"),
    "answers no ping": (["ping"], replace(GOOD_2, answers_pings=False), "ping", "does not send (ping 7) back"),
    "sends nothing": (["ping"], replace(GOOD_2, keeps_alive=False), "lease", "a (ping) now and then keeps it"),
    "stays away": (["restart"], replace(GOOD_1, asks_again=False), "restart", "did not find the restarted server"),
    "comes back": (["replaced"], replace(GOOD_1, obeys_replaced=False), "replaced", "without end"),
    "floods": (["opening"], replace(GOOD_1, floods=True), "flood", "servers drop more than 100"),
}


@pytest.mark.parametrize(("acts", "habits", "name", "said"), WRONG.values(), ids=WRONG.keys())
def test_a_wrong_client_is_told_what_it_does_wrong(
    acts: list[str], habits: Habits, name: str, said: str, server: TrialServer
) -> None:
    found = examine(server, habits, *acts)
    assert name in found, found
    assert found[name].grade is not Grade.GOOD, found
    assert said in found[name].sentence


def test_a_bye_to_the_port_of_init_is_told(server: TrialServer) -> None:
    with Robot(server.port, replace(GOOD_1, bye_to_main=True)):
        assert server.play(2.0, lambda: server.session is not None)
    server.play(0.1)
    found = {finding.name: finding for finding in examine_client(server, ["none"], wait_s=1.0)}
    assert "send it to the port that the views came from" in found["bye"].sentence
    assert found["verdict"].grade is Grade.DOUBTFUL


def test_nobody_comes(server: TrialServer) -> None:
    found = list(examine_client(server, wait_s=0.1))
    assert [finding.name for finding in found] == ["init", "verdict"]
    assert "no datagram came" in found[0].sentence


def test_a_port_that_is_taken_is_named(server: TrialServer) -> None:
    with pytest.raises(ServiceError, match="two free ports"):
        TrialServer("127.0.0.1", server.port, Program(()), MonotonicClock())


def test_a_program_that_cannot_be_started_is_named(capsys: pytest.CaptureFixture[str], server: TrialServer) -> None:
    assert main(["check-client", "--port", str(server.port + 7), "--", "/no/such/program"]) == Grade.BAD
    assert "No such file" in capsys.readouterr().err
