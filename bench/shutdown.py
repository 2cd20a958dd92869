"""What ends for good: a task that is killed again and again, and a service whose supervisor is killed."""

import os
import signal
import socket
import time
from pathlib import Path

from bench.fault_targets import PATIENCE_S, Service
from bench.frame_path import VIEWS
from bench.helpers import sit_out
from bench.runner import Row
from bench.service import RunningService, is_alive
from vision_core.net.control import restart
from vision_core.rtdb.process_state import ProcessState

TARGET = "watch"
"""Robots are served without it."""
CRASHES_TO_DISABLE = 5
LOOK_EVERY_S = 0.01
OTHERS_S = 2.0
MINUTE_S = 60.0
AFTER_S = 1.0
BLOCK = "memfd:pslv-rtdb"
LOOPBACK = "127.0.0.1"


def disabling(service: Service) -> list[Row]:
    """Five kills within a minute: the task is disabled, that is said, others go on, and it can be tried again."""
    sit_out(MINUTE_S, "faults: a minute without any")
    service.wait_until_complete()
    began = time.monotonic()
    for _ in range(CRASHES_TO_DISABLE):
        pid = _wait_for(service, ProcessState.RUNNING)
        assert pid is not None
        os.kill(pid, signal.SIGKILL)
        while service.process(TARGET).pid == pid:
            time.sleep(LOOK_EVERY_S)
    _wait_for(service, ProcessState.DISABLED)
    took_s = time.monotonic() - began
    views = service.attached.store.reader(VIEWS)
    before = views.sequence
    time.sleep(OTHERS_S)
    rate = (views.sequence - before) / OTHERS_S
    said = _said(service)
    asked = time.monotonic()
    restart(service.running.control, TARGET)
    _wait_for(service, ProcessState.RUNNING)
    again_s = time.monotonic() - asked
    name = f"{TARGET} killed {CRASHES_TO_DISABLE} times"
    return [
        {"name": f"{name}: disabled after", "value": round(took_s, 1), "unit": "s"},
        {"name": f"{name}: /api/v1/status says {said!r}", "goal": "is said", "met": ProcessState.DISABLED in said},
        {"name": f"{name}: views a second meanwhile", "value": round(rate, 1), "unit": "1/s", "goal": "> 25 1/s",
         "met": rate > 25.0},
        {"name": f"{name}: runs again after a restart, within", "value": round(again_s, 2), "unit": "s"},
    ]  # fmt: skip


def _wait_for(service: Service, state: str) -> int | None:
    """Wait until the target is in a state; its process id. Raises RuntimeError when it never is."""
    deadline = time.monotonic() + PATIENCE_S
    while (row := service.process(TARGET)).state != state:
        if time.monotonic() > deadline:
            raise RuntimeError(f"{TARGET}: {row.state} ({row.detail}) was found; {state} was expected")
        time.sleep(LOOK_EVERY_S)
    return row.pid


def _said(service: Service) -> str:
    """What the status tells of the target, in the table of processes and in words."""
    status = service.running.get("/api/v1/status")[1]
    row = next(row for row in status["processes"] if row["name"] == TARGET)
    words = [word for word in (*status["degraded"], *status["reasons"]) if TARGET in word]
    return "; ".join([f"{row['state']}, {row['detail']}", *words])


def killed_supervisor(running: RunningService) -> list[Row]:
    """kill -9: its processes, its memory and its sockets are gone a second later. Nobody else may hold the database."""
    pid, pids = running.process.pid, [*running.pids().values(), running.process.pid]
    block = _block_of(pid)
    shared = _shared_memory()
    running.process.kill()
    time.sleep(AFTER_S)
    running.process.wait()
    left = {
        "processes left": sum(is_alive(one) for one in pids),
        "processes that hold its memory": len(_holders(block)),
        "files in /dev/shm beyond those before": len(_shared_memory() - shared),
        "control sockets left": int(f"@{running.control}" in Path("/proc/net/unix").read_text().split()),
        "ports that are not free again": _ports_taken(running),
    }
    name = f"{AFTER_S:g} s after the supervisor's kill -9"
    return [{"name": f"{name}: {what}", "value": count, "goal": "0", "met": not count} for what, count in left.items()]


def _block_of(pid: int) -> int:
    """Inode of a process's database. Raises LookupError when it has none."""
    for link in Path(f"/proc/{pid}/fd").iterdir():
        if BLOCK in str(link.readlink()):
            return link.stat().st_ino
    raise LookupError(f"process {pid}: no descriptor of {BLOCK} was found; one was expected")


def _holders(block: int) -> set[int]:
    """Processes that have a database mapped, or open."""
    found = set()
    for process in Path("/proc").glob("[0-9]*"):
        try:
            maps = (process / "maps").read_text().splitlines()
            mapped = any(BLOCK in line and int(line.split()[4]) == block for line in maps)
            opened = any(BLOCK in str(fd.readlink()) and fd.stat().st_ino == block for fd in (process / "fd").iterdir())
        except OSError:  # it has ended
            continue
        if mapped or opened:
            found.add(int(process.name))
    return found


def _shared_memory() -> set[str]:
    folder = Path("/dev/shm")
    return {path.name for path in folder.iterdir()} if folder.is_dir() else set()


def _ports_taken(running: RunningService) -> int:
    """Of the page's, the robots' and the sessions' ports, those at which nobody else could listen."""
    http = int(running.http.rpartition(":")[2])
    wanted = [(socket.SOCK_STREAM, http), *((socket.SOCK_DGRAM, running.udp_port + more) for more in (0, 1))]
    taken = 0
    for kind, port in wanted:
        with socket.socket(socket.AF_INET, kind) as probe:
            if kind == socket.SOCK_STREAM:
                probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)  # ended connections linger
            try:
                probe.bind((LOOPBACK, port))
            except OSError:
                taken += 1
    return taken
