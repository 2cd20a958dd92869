"""The whole service restarts with other settings; its clients keep their sessions. What cannot start is refused."""

import socket
import subprocess
import sys
from pathlib import Path

import pytest

from bench.service import RunningService, running_service
from tests.app.fake_service import wait_for
from tests.faults.test_service import listener, time_of

pytestmark = [pytest.mark.slow, pytest.mark.timeout(300)]
PATIENCE_S = 120.0


def restart_of(service: RunningService) -> dict[str, object]:
    """What became of the newest request; empty while the web process is away."""
    try:
        return dict(service.get("/api/v1/restart")[1])
    except OSError:
        return {}


def pslv(*arguments: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "app.main", *arguments]
    return subprocess.run(command, capture_output=True, text=True, check=False, timeout=PATIENCE_S)


def is_answered(client: socket.socket, server: tuple[str, int]) -> bool:
    """Ask the session; an answer is lost while views of a minute fill the client's buffer."""
    client.sendto(b"(mirror)", server)
    return any(client.recv(4096).startswith(b"(mirror ") for _ in range(30))


def test_a_restart_takes_over_settings_and_keeps_the_clients(tmp_path: Path) -> None:
    config = tmp_path / "hall.toml"
    config.write_text("[protocol]\nlease_s = 500.0\n")
    with running_service("--config", str(config)) as service:
        client, server = listener(service, "blue", 2)
        with client:
            before = time_of(client.recv(4096))
            pids = service.pids()
            assert service.request("PATCH", "/api/v1/settings", {"changes": {"camera.rate_hz": 20.0}})[0] == 200
            assert service.get("/api/v1/settings")[1]["waits_for_restart"] == ["camera.rate_hz"]

            done = pslv("restart", "--service", service.control)
            assert done.returncode == 0, done.stderr
            assert "clients stay connected" in done.stdout
            wait_for(lambda: is_answered(client, server), PATIENCE_S)
            wait_for(lambda: client.recv(4096) and restart_of(service).get("count") == 1, PATIENCE_S)
            wait_for(lambda: client.recv(4096) and service.get("/readyz")[0] == 200, PATIENCE_S)
            settings = service.get("/api/v1/settings")[1]
            assert settings["waits_for_restart"] == []
            status = service.get("/api/v1/status")[1]
            assert status["cameras"][0]["rate_hz"] == 20.0
            assert status["uptime_s"] > 0.0
            assert [(c["team"], c["number"]) for c in status["clients"]] == [("blue", 2)]
            assert not set(service.pids().values()) & set(pids.values())

            config.write_text("[protocol]\nlease_s = -1.0\n")
            refused = pslv("restart", "--service", service.control)
            assert refused.returncode != 0
            assert "hall.toml" in refused.stderr
            assert "lease_s" in refused.stderr
            report = restart_of(service)
            assert (report["state"], report["count"]) == ("refused", 1)
            while not (message := client.recv(4096)).startswith(b"(see "):
                pass
            assert time_of(message) > before

            client.sendto(b"(bye)", server)


def test_a_stop_while_a_restart_is_prepared_stops_everything() -> None:
    with running_service() as service:
        assert service.request("POST", "/api/v1/restart")[0] == 202
        wait_for(lambda: "1 of" in str(restart_of(service).get("detail")), PATIENCE_S)
        assert service.stop() == 0
