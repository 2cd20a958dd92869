"""Starts the real service (``pslv serve``) for a benchmark or a test, on free ports of loopback, and stops it."""

import contextlib
import json
import os
import re
import signal
import subprocess
import sys
import tempfile
import time
import urllib.error
import urllib.request
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from app.web.auth.people import People
from vision_core.net.control import Attached, attach_to

START_TIMEOUT_S = 290.0
STOP_TIMEOUT_S = 10.0


@dataclass
class RunningService:
    """A service that runs and is ready."""

    process: subprocess.Popen[str]
    http: str
    """Address of its page."""
    udp_port: int
    token: str
    """Of the operator."""

    @property
    def control(self) -> str:
        """Name of its control socket; see ``vision_core.net.control``."""
        return f"pslv/{self.http.rpartition(':')[2]}"

    def get(self, path: str) -> tuple[int, Any]:
        """Status code and body of a page: decoded when it is JSON, else bytes."""
        return self.request("GET", path)

    def request(self, method: str, path: str, body: object = None) -> tuple[int, Any]:
        """Status code and body of the answer to a request, as ``get``; body: sent as JSON."""
        content = None if body is None else json.dumps(body).encode()
        headers = {"authorization": f"Bearer {self.token}"}
        if content is not None:
            headers["content-type"] = "application/json"
        asked = urllib.request.Request(self.http + path, content, headers, method=method)
        try:
            with urllib.request.urlopen(asked, timeout=5.0) as response:
                code, answer, kind = response.status, response.read(), response.headers.get_content_type()
        except urllib.error.HTTPError as error:
            code, answer, kind = error.code, error.read(), error.headers.get_content_type()
        return code, json.loads(answer) if answer and kind.endswith("json") else answer

    def pids(self) -> dict[str, int]:
        """Ids of all its running processes by name."""
        status = self.get("/api/v1/status")[1]
        return {row["name"]: row["pid"] for row in status["processes"] if row["pid"] is not None}

    def stop(self, number: signal.Signals = signal.SIGTERM) -> int:
        """Stop it with a signal. Returns its exit status."""
        self.process.send_signal(number)
        return self.process.wait(timeout=STOP_TIMEOUT_S)


@contextlib.contextmanager
def running_service(*options: str, variables: Mapping[str, str] | None = None) -> Iterator[RunningService]:
    """A ready service on free ports; it is stopped at the end of the block, also after an error.

    options: further arguments of ``pslv serve``. variables: further environment variables. Raises RuntimeError with the
    service's log when it ends or is not ready within START_TIMEOUT_S.
    """
    # it appends, wherever the benchmark reads: they share one place in the file
    with tempfile.TemporaryFile("a+") as log, tempfile.TemporaryDirectory() as folder:
        environment = {**os.environ, "PSLV_DATABASE": folder, **(variables or {})}
        token = operator_token(Path(environment["PSLV_DATABASE"]))
        process = subprocess.Popen(
            [sys.executable, "-m", "app.main", "serve", "--port", "0", "--udp-port", "0", *options],
            cwd=Path(__file__).resolve().parents[1],
            env=environment | {"COLUMNS": "200"},
            stdout=log,
            stderr=log,
            text=True,
        )
        try:
            yield _ready(process, log, token)
        finally:
            process.send_signal(signal.SIGTERM)
            try:
                process.wait(timeout=STOP_TIMEOUT_S)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()


@contextlib.contextmanager
def attached_service(
    settings: str, *options: str, variables: Mapping[str, str] | None = None
) -> Iterator[tuple[RunningService, Attached]]:
    """``running_service`` with a settings file of a text, and its database."""
    with contextlib.ExitStack() as stack:
        path = stack.enter_context(configured(settings))
        service = stack.enter_context(running_service("--config", path, *options, variables=variables))
        attached = attach_to(service.control)
        stack.callback(attached.close)
        yield service, attached


@contextlib.contextmanager
def configured(text: str) -> Iterator[str]:
    """A settings file with a text, for the service's ``--config``. Yields its path; the block's end removes it."""
    with tempfile.TemporaryDirectory(prefix="pslv-bench-") as folder:
        path = Path(folder) / "bench.toml"
        path.write_text(text, encoding="utf-8")
        yield str(path)


def is_alive(pid: int) -> bool:
    """Does a process run? A zombie does not."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0] != "Z"
    except FileNotFoundError:
        return False


def operator_token(folder: Path) -> str:
    """A new token in a service's database."""
    people = People(folder / "people.db")
    secret = people.new_token("bench")[1]
    people.close()
    return secret


def _ready(process: subprocess.Popen[str], log: Any, token: str) -> RunningService:
    """Wait until the service has logged its addresses and /readyz answers 200."""
    began = time.monotonic()
    while time.monotonic() - began < START_TIMEOUT_S:
        time.sleep(0.02)
        log.seek(0)
        text = log.read()
        if process.poll() is not None:
            raise RuntimeError(f"the service ended with status {process.returncode}: {text}")
        found = re.search(r"page (http://\S+), robots at UDP \S+:(\d+)", text)
        if found is None:
            continue
        service = RunningService(process, found[1], int(found[2]), token)
        with contextlib.suppress(OSError):
            if service.get("/readyz")[0] == 200:
                return service
    log.seek(0)
    raise RuntimeError(f"the service was not ready in time: {log.read()}")
