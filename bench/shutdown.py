"""The two faults without recovery of the benchmark ``faults``: a task that crashes repeatedly, a killed supervisor."""

import os
import signal
import socket
import time
from pathlib import Path

from bench.fault_targets import TIMEOUT_S, ServiceUnderTest
from bench.frame_path import VIEWS
from bench.helpers import wait_with_progress
from bench.runner import Row
from bench.service import RunningService, is_alive
from vision_core.net.control import restart, running_services
from vision_core.rtdb.process_state import ProcessState

TARGET = "watch"
"""The process that is killed repeatedly; no robot's view depends on it."""
KILLS = 5
"""After so many within a minute the supervisor disables a process."""
POLL_EVERY_S = 0.01
RATE_OVER_S = 2.0
MIN_RATE_HZ = 25.0
MINUTE_S = 60.0
GONE_WITHIN_S = 1.0
BLOCK = "memfd:pslv-rtdb"
LOOPBACK = "127.0.0.1"


def kill_repeatedly(service: ServiceUnderTest) -> list[Row]:
    """Kill one process five times within a minute. It must be disabled and the status must say so; robots stay served.

    Afterwards it is restarted by command.
    """
    wait_with_progress(MINUTE_S, "faults: a minute without any")
    service.wait_until_healthy()
    began = time.monotonic()
    for _ in range(KILLS):
        pid = _wait_for(service, ProcessState.RUNNING)
        assert pid is not None
        os.kill(pid, signal.SIGKILL)
        while service.process(TARGET).pid == pid:
            time.sleep(POLL_EVERY_S)
    _wait_for(service, ProcessState.DISABLED)
    disabled_after_s = time.monotonic() - began
    views = service.attached.store.reader(VIEWS)
    before = views.sequence
    time.sleep(RATE_OVER_S)
    rate_hz = (views.sequence - before) / RATE_OVER_S
    status = _status_of_target(service)
    requested = time.monotonic()
    restart(service.running.control, TARGET)
    _wait_for(service, ProcessState.RUNNING)
    restarted_after_s = time.monotonic() - requested
    name = f"{TARGET} killed {KILLS} times"
    return [
        {"name": f"{name}: disabled after", "value": round(disabled_after_s, 1), "unit": "s"},
        {"name": f"{name}: /api/v1/status says {status!r}", "goal": "says disabled",
         "met": ProcessState.DISABLED in status},
        {"name": f"{name}: views per second meanwhile", "value": round(rate_hz, 1), "unit": "1/s",
         "goal": f"> {MIN_RATE_HZ:g} 1/s", "met": rate_hz > MIN_RATE_HZ},
        {"name": f"{name}: runs again after a restart command, within", "value": round(restarted_after_s, 2),
         "unit": "s"},
    ]  # fmt: skip


def _wait_for(service: ServiceUnderTest, state: ProcessState) -> int | None:
    """Wait until the target is in a state. Returns its process id. Raises RuntimeError after TIMEOUT_S."""
    deadline = time.monotonic() + TIMEOUT_S
    while (row := service.process(TARGET)).state != state:
        if time.monotonic() > deadline:
            raise RuntimeError(f"{TARGET}: {row.state} ({row.detail}) was found; {state} was expected")
        time.sleep(POLL_EVERY_S)
    return row.pid


def _status_of_target(service: ServiceUnderTest) -> str:
    """What /api/v1/status says of the target: its row in the table of processes, and all sentences that name it."""
    status = service.running.get("/api/v1/status")[1]
    row = next(row for row in status["processes"] if row["name"] == TARGET)
    sentences = [sentence for sentence in (*status["degraded"], *status["reasons"]) if TARGET in sentence]
    return "; ".join([f"{row['state']}, {row['detail']}", *sentences])


def kill_supervisor(running: RunningService) -> list[Row]:
    """Kill the supervisor (SIGKILL). A second later all processes, shared memory and sockets of the service are gone.

    This process must have closed the service's database before.
    """
    pid, pids = running.process.pid, [*running.pids().values(), running.process.pid]
    block = _inode_of_database(pid)
    files = _shared_memory_files()
    running.process.kill()
    time.sleep(GONE_WITHIN_S)
    running.process.wait()
    left = {
        "processes left": sum(is_alive(one) for one in pids),
        "processes that have its database mapped or open": len(_users_of(block)),
        "additional files in /dev/shm": len(_shared_memory_files() - files),
        "control sockets that answer": int(running.control in running_services()),
        "ports that cannot be bound again": _ports_in_use(running),
    }
    name = f"{GONE_WITHIN_S:g} s after the supervisor's SIGKILL"
    return [{"name": f"{name}: {what}", "value": count, "goal": "0", "met": not count} for what, count in left.items()]


def _inode_of_database(pid: int) -> int:
    """Inode of the database that a process has open. Raises LookupError when it has none."""
    for link in Path(f"/proc/{pid}/fd").iterdir():
        if BLOCK in str(link.readlink()):
            return link.stat().st_ino
    raise LookupError(f"process {pid}: no descriptor of {BLOCK} was found; one was expected")


def _users_of(block: int) -> set[int]:
    """Process ids that have a database mapped or open. block: its inode."""
    users = set()
    for process in Path("/proc").glob("[0-9]*"):
        try:
            maps = (process / "maps").read_text().splitlines()
            mapped = any(BLOCK in line and int(line.split()[4]) == block for line in maps)
            opened = any(BLOCK in str(fd.readlink()) and fd.stat().st_ino == block for fd in (process / "fd").iterdir())
        except OSError:  # it has ended
            continue
        if mapped or opened:
            users.add(int(process.name))
    return users


def _shared_memory_files() -> set[str]:
    folder = Path("/dev/shm")
    return {path.name for path in folder.iterdir()} if folder.is_dir() else set()


def _ports_in_use(running: RunningService) -> int:
    """How many of the ports of page, robots and sessions cannot be bound."""
    http = int(running.http.rpartition(":")[2])
    ports = [(socket.SOCK_STREAM, http), *((socket.SOCK_DGRAM, running.udp_port + more) for more in (0, 1))]
    in_use = 0
    for kind, port in ports:
        with socket.socket(socket.AF_INET, kind) as probe:
            if kind == socket.SOCK_STREAM:
                probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)  # connections in TIME_WAIT are no obstacle
            try:
                probe.bind((LOOPBACK, port))
            except OSError:
                in_use += 1
    return in_use
