"""Starts and stops the real service for a benchmark or a test, on free ports of loopback."""

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

START_PATIENCE_S = 180.0
STOP_PATIENCE_S = 10.0


@dataclass
class RunningService:
    """A service that runs."""

    process: subprocess.Popen[str]
    http: str
    udp_port: int

    @property
    def control(self) -> str:
        """Name of its control socket, for ``vision_core.net.control``."""
        return f"pslv/{self.http.rpartition(':')[2]}"

    def get(self, path: str) -> tuple[int, Any]:
        """Status code and decoded JSON (or bytes) of a page."""
        try:
            with urllib.request.urlopen(self.http + path, timeout=5.0) as answer:
                code, body, kind = answer.status, answer.read(), answer.headers.get_content_type()
        except urllib.error.HTTPError as error:
            code, body, kind = error.code, error.read(), error.headers.get_content_type()
        return code, json.loads(body) if kind.endswith("json") else body

    def pids(self) -> dict[str, int]:
        """Process ids of all running processes by name."""
        status = self.get("/api/v1/status")[1]
        return {row["name"]: row["pid"] for row in status["processes"] if row["pid"] is not None}

    def stop(self, number: signal.Signals = signal.SIGTERM) -> int:
        """Stop it; returns its exit status."""
        self.process.send_signal(number)
        return self.process.wait(timeout=STOP_PATIENCE_S)


@contextlib.contextmanager
def running_service(
    *options: str, data_folder: Path | None = None, variables: Mapping[str, str] | None = None
) -> Iterator[RunningService]:
    """A service on free ports, ready; ended when the block ends, whatever happens in it.

    variables: of its environment, beside ours.
    """
    with tempfile.TemporaryFile("w+") as log:
        environment = {**os.environ, **(variables or {})}
        if data_folder is not None:
            environment["PSLV_DATA_DIR"] = str(data_folder)
        process = subprocess.Popen(
            [sys.executable, "-m", "app.main", "serve", "--port", "0", "--udp-port", "0", *options],
            cwd=Path(__file__).resolve().parents[1],
            env=environment | {"COLUMNS": "200"},
            stdout=log,
            stderr=log,
            text=True,
        )
        try:
            yield _ready(process, log)
        finally:
            process.send_signal(signal.SIGTERM)
            try:
                process.wait(timeout=STOP_PATIENCE_S)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()


@contextlib.contextmanager
def configured(text: str) -> Iterator[str]:
    """A settings file for the service's ``--config``, there while the block runs; yields its path."""
    with tempfile.TemporaryDirectory(prefix="pslv-bench-") as folder:
        path = Path(folder) / "bench.toml"
        path.write_text(text, encoding="utf-8")
        yield str(path)


def is_alive(pid: int) -> bool:
    """Does a process run? One that has ended and waits for its parent does not."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0] != "Z"
    except FileNotFoundError:
        return False


def _ready(process: subprocess.Popen[str], log: Any) -> RunningService:
    """Wait until the service says that it is ready."""
    began = time.monotonic()
    while time.monotonic() - began < START_PATIENCE_S:
        time.sleep(0.02)
        log.seek(0)
        text = log.read()
        if process.poll() is not None:
            raise RuntimeError(f"the service ended with status {process.returncode}: {text}")
        found = re.search(r"page (http://\S+), robots at UDP \S+:(\d+)", text)
        if found is None:
            continue
        service = RunningService(process, found[1], int(found[2]))
        with contextlib.suppress(OSError):
            if service.get("/readyz")[0] == 200:
                return service
    log.seek(0)
    raise RuntimeError(f"the service was not ready in time: {log.read()}")
