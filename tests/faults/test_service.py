"""The real service through its front door: start, clients, killed processes, bad input, stop."""

import contextlib
import io
import json
import os
import re
import signal
import socket
import subprocess
import sys
import time
import zipfile
from collections.abc import Iterator
from pathlib import Path

import pytest

from app.launch.resource_owners import lock_camera
from bench.service import RunningService, is_alive, running_service
from tests.conftest import ROOT
from vision_core.clock import MonotonicClock
from vision_core.net.control import attach_to

pytestmark = [pytest.mark.slow, pytest.mark.timeout(300)]
PAPER_CLIENT = ROOT / "bench" / "paper_client.py"
PATIENCE_S = 30.0
PROCESSES = {"log_reader", "responder", "source", "capture", "perceive", "obstacles", "watch", "follow", "diagnose"} | {
    "serve",
    "web",
}
SPARES = {"spare-1", "spare-2"}
SERVE = [sys.executable, "-m", "app.main", "serve", "--port", "0", "--udp-port", "0"]


@pytest.fixture(scope="module")
def service() -> Iterator[RunningService]:
    with running_service() as started:
        until_settled(started)
        yield started


def until_settled(service: RunningService, spares: int = len(SPARES)) -> None:
    """Everything runs, so many spares too: robots are served before that."""
    deadline = time.monotonic() + 4.0 * PATIENCE_S
    while not ((running := states_of(service).keys()) >= PROCESSES and len(running & SPARES) >= spares):
        assert time.monotonic() < deadline
        time.sleep(0.1)


def states_of(service: RunningService) -> dict[str, int]:
    """Process ids of what runs, by name."""
    rows = service.get("/api/v1/status")[1]["processes"]
    return {row["name"]: row["pid"] for row in rows if row["state"] == "running"}


def listener(service: RunningService, team: str, number: int) -> tuple[socket.socket, tuple[str, int]]:
    """A connected client: its socket and the address that serves it."""
    client = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    client.settimeout(PATIENCE_S)
    reply, server = b"(error not_ready)", ("", 0)
    while reply == b"(error not_ready)":  # the last one that it was: it has just become ready
        client.sendto(f"(init {team} {number})".encode(), ("127.0.0.1", service.udp_port))
        reply, server = client.recvfrom(4096)
    assert reply == f"(init {team} {number} play_on)".encode()
    return client, server


def time_of(message: bytes) -> float:
    assert message.startswith(b"(see "), message
    return float(message.split()[1])


def test_it_is_healthy_ready_and_says_what_it_is(service: RunningService) -> None:
    assert service.get("/healthz")[0] == 200
    assert service.get("/readyz")[0] == 200
    code, status = service.get("/api/v1/status")
    assert code == 200
    assert status["ready"] is True
    assert status["reasons"] == []
    assert {"version", "source", "cameras", "clients", "processes"} <= status.keys()
    states = {row["name"]: row["state"] for row in status["processes"]}
    # the compilers run only where a kernel is missing
    assert {states.pop("compile", "done"), states.pop("compile_others", "done")} == {"done"}
    assert states == dict.fromkeys((*PROCESSES, *SPARES), "running")


def test_how_its_tasks_run_is_printed(service: RunningService) -> None:
    name = f"pslv/{service.http.rsplit(':', 1)[1]}"
    command = [sys.executable, "-m", "app.main", "tasks", "--live", "--service", name]
    header, *rows = subprocess.run(command, check=True, capture_output=True, text=True).stdout.splitlines()
    assert header.split()[:6] == ["task", "policy", "runs", "missed", "overruns", "Hz"]
    reported = {row.split()[0]: row for row in rows}
    assert reported.keys() >= {"capture", "perceive", "serve", "boundary", "web"}
    runs = re.search(r"(?:FIFO \d+|nice -?\d+|ordinary) +(\d+)", reported["perceive"])
    assert runs
    assert int(runs[1]) > 10


def test_ten_clients_from_the_papers_text(service: RunningService) -> None:
    robots = [(team, str(number)) for team in ("blue", "yellow") for number in range(1, 6)]
    command = [sys.executable, str(PAPER_CLIENT)]
    clients = [
        subprocess.Popen([*command, *robot, "3", "127.0.0.1", str(service.udp_port)], stdout=subprocess.PIPE, text=True)
        for robot in robots
    ]
    for client, (team, number) in zip(clients, robots, strict=True):
        report = json.loads(client.communicate(timeout=PATIENCE_S)[0])
        assert report["init"] == f"(init {team} {number} play_on)"
        assert report["wrong"] == []
        assert report["increasing"]
        assert report["messages"] > 10


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGSTOP])
@pytest.mark.parametrize("name", ["source", "capture", "perceive", "serve", "web"])
def test_a_lost_process_comes_back_and_sessions_go_on(
    service: RunningService, name: str, number: signal.Signals
) -> None:
    until_settled(service, spares=1)
    client, server = listener(service, "blue", 1)
    with client:
        client.recv(4096)
        others = service.pids()
        target = others.pop(name)
        os.kill(target, number)
        deadline = time.monotonic() + PATIENCE_S
        last = 0.0
        back = False
        while not back:
            assert time.monotonic() < deadline, f"{name} did not come back"
            message, sender = client.recvfrom(4096)
            assert sender == server
            assert time_of(message) > last
            last = time_of(message)
            try:
                back = service.pids().get(name, target) != target and service.get("/readyz")[0] == 200
            except OSError:  # the page itself was killed
                continue
        for _ in range(10):
            assert time_of(client.recv(4096)) > last
        now = service.pids()
        assert {key: now[key] for key in PROCESSES - {name}} == {key: others[key] for key in PROCESSES - {name}}
        client.sendto(b"(bye)", server)


def log_until(service: RunningService, text: str, query: str = "") -> dict[str, str]:
    """Process and level of the newest line of the log with a text."""
    deadline = time.monotonic() + PATIENCE_S
    while True:
        lines = service.get(f"/api/v1/log{query}")[1]["lines"]
        found = [line for line in lines if text in line["text"]]
        if found:
            return {key: found[-1][key] for key in ("process", "level")}
        assert time.monotonic() < deadline, (text, lines)
        time.sleep(0.1)


def test_the_log_tells_what_every_process_says(service: RunningService) -> None:
    assert log_until(service, f"page {service.http}, robots at UDP") == {"process": "supervisor", "level": "info"}
    assert "token=" not in json.dumps(service.get("/api/v1/log")[1])
    assert log_until(service, "processes run") == {"process": "supervisor", "level": "info"}
    assert log_until(service, "ready", "?process=web")["process"] == "web"
    until_settled(service, spares=1)
    os.kill(service.pids()["diagnose"], signal.SIGKILL)
    purposes = (
        "finds robots whose colors cannot be seen, explains why something is not seen, "
        "draws what is found while somebody looks"
    )
    ended = f"diagnose ({purposes}) ended with signal SIGKILL"
    assert log_until(service, ended, "?level=warning") == {"process": "supervisor", "level": "warning"}
    until_settled(service, spares=1)


def test_a_log_reader_that_is_lost_comes_back_and_goes_on(service: RunningService) -> None:
    until_settled(service)
    before = service.get("/api/v1/log")[1]["lines"]
    os.kill(service.pids()["log_reader"], signal.SIGKILL)
    assert log_until(service, "log_reader (prints what the others print) ended")["process"] == "supervisor"
    after = service.get("/api/v1/log")[1]["lines"]
    assert [line["number"] for line in after[: len(before)]] == [line["number"] for line in before]
    until_settled(service)


def test_a_support_bundle_of_the_page_and_of_the_command_line(service: RunningService, tmp_path: Path) -> None:
    until_settled(service)
    code, packed = service.get("/api/v1/support-bundle")
    assert code == 200
    path = tmp_path / "bundle.zip"
    command = [sys.executable, "-m", "app.main", "support-bundle", "--service", service.control, str(path)]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 0, done.stderr
    with zipfile.ZipFile(io.BytesIO(packed)) as first, zipfile.ZipFile(path) as second:
        assert first.namelist() == second.namelist()
        assert "processes run" in second.read("log.txt").decode()
        assert second.read("snapshot.jpg").startswith(b"\xff\xd8")
        assert service.token not in (first.read("log.txt") + first.read("changes.json")).decode()


def test_malformed_datagrams_hurt_nobody(service: RunningService) -> None:
    client, server = listener(service, "yellow", 5)
    garbage = [b"", b"\0", b"(" * 10_000, b")", b"(init", b"(init blue 99999999999999999999)", b"\xff" * 60_000]
    with client, socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as stranger:
        for datagram in garbage:
            for port in (service.udp_port, server[1]):
                stranger.sendto(datagram, ("127.0.0.1", port))
        last = 0.0
        for _ in range(20):
            now = time_of(client.recv(4096))
            assert now > last
            last = now
        client.sendto(b"(bye)", server)
    assert service.get("/readyz")[0] == 200


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_stop_leaves_nothing(number: signal.Signals) -> None:
    memory, data = Path("/dev/shm"), ROOT / ".pslv"
    before = {*memory.iterdir(), *data.iterdir()}
    with running_service() as started:
        pids = list(started.pids().values())
        assert started.stop(number) == 0
    assert not [pid for pid in pids if is_alive(pid)]
    assert {*memory.iterdir(), *data.iterdir()} <= before


def test_a_killed_supervisor_leaves_no_process() -> None:
    with running_service() as started:
        pids = list(started.pids().values())
        started.process.kill()
        started.process.wait()
        deadline = time.monotonic() + 5.0
        while any(is_alive(pid) for pid in pids) and time.monotonic() < deadline:
            time.sleep(0.01)
        assert not [pid for pid in pids if is_alive(pid)]


def refused(*options: str) -> str:
    """Start with bad options; returns what was said. It must end with status 2 and start nothing."""
    result = subprocess.run(
        [*SERVE, *options],
        check=False,
        cwd=ROOT,
        capture_output=True,
        text=True,
        timeout=PATIENCE_S,
        env=os.environ | {"COLUMNS": "400"},
    )
    assert result.returncode == 2, result
    assert "Traceback" not in result.stderr
    assert "page http" not in result.stderr
    return result.stderr


def test_ports_in_use_are_named(service: RunningService) -> None:
    http = service.http.rsplit(":", 1)[1]
    ours = f"process {service.process.pid} (python"
    assert re.search(rf"TCP port {http} .*in use, by {re.escape(ours)}", refused("--port", http))
    said = refused("--udp-port", str(service.udp_port))
    assert re.search(rf"{service.udp_port}.*, by {re.escape(ours)}", said)


def test_a_camera_that_another_server_has_is_named() -> None:
    with lock_camera("/dev/pslv-test"):
        said = refused("--source", "camera:/dev/pslv-test")
    assert f"camera /dev/pslv-test; found: process {os.getpid()} (" in said


def test_a_table_that_cannot_work_is_refused_with_its_line(tmp_path: Path) -> None:
    venue = tmp_path / "venue.toml"
    venue.write_text("[tasks.perceive]\n\nbudget_ms = 40.0\n")
    assert f"{venue}, line 3: tasks.perceive.budget_ms; found: 40 for what comes every 33.3" in refused(
        "--venue", str(venue)
    )


def test_a_task_of_ones_own_runs_in_the_service(tmp_path: Path) -> None:
    venue = tmp_path / "venue.toml"
    venue.write_text(
        '[tasks.nearest]\nmodule = "examples.own_task"\npriority = 10\nperiod_ms = 100.0\nbudget_ms = 2.0\n'
        'reads = ["world"]\nwrites = ["lab/nearest"]\n'
    )
    with running_service("--venue", str(venue)) as started:
        attached = attach_to(f"pslv/{started.http.rsplit(':', 1)[1]}")
        deadline = time.monotonic() + PATIENCE_S
        reader = attached.store.reader("lab/nearest")
        while (reading := reader.read(MonotonicClock().now())) is None:
            assert time.monotonic() < deadline
            time.sleep(0.05)
        assert reading.value.endswith(b" m")
        attached.close()


def test_bad_sources_are_named(tmp_path: Path) -> None:
    empty = tmp_path / "empty.png"
    empty.touch()
    assert "accepted: synthetic" in refused("--source", "telepathy:0")
    assert str(empty) in refused("--source", f"file:{empty}")
    assert "nowhere.png" in refused("--source", "file:nowhere.png")
    assert "camera" in refused("--source", "camera:/dev/no-such-camera")
    assert "camera" in refused("--source", f"camera:{'9' * 30}")
    assert "File name too long" in refused("--source", f"file:{'x' * 300}")
    assert "not played: empty.png: an empty file" in refused("--source", f"file:{tmp_path}")


def test_bad_settings_are_named(tmp_path: Path) -> None:
    venue = tmp_path / "venue.toml"
    venue.write_text("[camera]\nrate = 30\n")
    said = refused("--venue", str(venue))
    assert f"{venue}, line 2: camera.rate; found: no setting of this name (did you mean rate_hz?)" in said
    assert "found: 99999; accepted: a whole number <= 65535" in refused("--port", "99999")
    assert "TCP port 0 at" in refused("--host", "\u00e4" * 80)
    boxes = ", ".join(["{ hue_deg = [1.0, 2.0], value = [0.1, 0.2] }"] * 600)
    colors = ("orange", "yellow", "blue", "pink", "green")
    venue.write_text("[colors.classes]\n" + "".join(f"{color} = [{boxes}]\n" for color in colors))
    assert "settings; found:" in refused("--venue", str(venue))


@pytest.mark.parametrize(
    ("number", "after_s"),
    [(signal.SIGINT, 0.6), (signal.SIGTERM, 1.0), (signal.SIGINT, 1.4), (signal.SIGTERM, 2.0)],
)
def test_a_stop_while_it_starts_is_a_stop(number: signal.Signals, after_s: float) -> None:
    """Whatever it is doing by then: loading, trying the source, starting its processes, compiling."""
    started = subprocess.Popen(SERVE, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    time.sleep(after_s)
    started.send_signal(number)
    said = started.communicate(timeout=PATIENCE_S)[0]  # ends when no process is left that could still write
    assert (started.returncode, "Traceback" in said) == (0, False), said


def test_a_log_that_nobody_reads_any_more_stops_nothing() -> None:
    with subprocess.Popen(SERVE, cwd=ROOT, stderr=subprocess.PIPE, text=True) as started:
        try:
            assert started.stderr is not None
            found = re.search(r"page (http://[0-9.:]+)", started.stderr.readline())
            assert found is not None
            started.stderr.close()
            service = RunningService(started, found[1], 0, "")
            until_ready(service)
            target = service.pids()["perceive"]
            os.kill(target, signal.SIGKILL)  # which is news for the log
            deadline = time.monotonic() + PATIENCE_S
            while service.pids().get("perceive", target) == target:
                assert time.monotonic() < deadline
            until_ready(service)
            assert service.stop() == 0
        finally:
            started.kill()


def until_ready(service: RunningService) -> None:
    deadline = time.monotonic() + PATIENCE_S
    while True:
        with contextlib.suppress(OSError):
            if service.get("/readyz")[0] == 200:
                return
        assert time.monotonic() < deadline
        assert service.process.poll() is None
        time.sleep(0.05)
