"""The supervisor starts, watches, restarts and ends processes, and leaves nothing behind."""

import contextlib
import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from typing import Any

import pytest

from bench.service import is_alive
from tests.conftest import ROOT
from vision_core.clock import MonotonicClock
from vision_core.errors import ServiceError
from vision_core.net.control import attach_to, restart
from vision_core.rtdb.log_record import LOG

Table = dict[str, dict[str, Any]]
PATIENCE_S = 30.0
BUSY = "import os; os.sched_setaffinity(0, {core})\nwhile True: pass"
SPARES = ("spare-1", "spare-2")


class Service:
    """A supervisor in a process of its own, and what it says."""

    def __init__(self, *names: str, stderr: int | None = None) -> None:
        """names: of the sleepers, and how many warm spares there are."""
        self.process = subprocess.Popen(
            [sys.executable, "-m", "tests.app.supervised_service", *names],
            cwd=ROOT,
            stdout=subprocess.PIPE,
            stderr=stderr,
            text=True,
        )
        self.log: list[str] = []
        self.control = f"pslv/test-{self.process.pid}"

    def tables(self) -> Iterator[Table]:
        """Every published table of processes, as it comes; ends with the supervisor."""
        assert self.process.stdout is not None
        for line in self.process.stdout:
            if line.startswith("processes "):
                yield {row["name"]: row for row in json.loads(line.removeprefix("processes "))}
            else:
                self.log.append(line.strip())

    def until(self, wanted: Any) -> Table:
        """The first table for which wanted(table) holds."""
        deadline = time.monotonic() + PATIENCE_S
        for table in self.tables():
            if wanted(table):
                return table
            assert time.monotonic() < deadline, (table, self.log)
        raise AssertionError(f"the supervisor ended: {self.log}")

    def running(self, *names: str) -> Table:
        return self.until(lambda table: all(table[name]["state"] == "running" for name in names))

    def close(self) -> None:
        self.process.kill()
        self.process.wait()
        assert self.process.stdout is not None
        self.process.stdout.close()


@contextlib.contextmanager
def service(*names: str, stderr: int | None = None) -> Iterator[Service]:
    started = Service(*names, stderr=stderr)
    try:
        yield started
    finally:
        started.close()


def all_gone(pids: list[int], patience_s: float = 5.0) -> bool:
    deadline = time.monotonic() + patience_s
    while any(is_alive(pid) for pid in pids):
        if time.monotonic() > deadline:
            return False
        time.sleep(0.01)
    return True


@pytest.mark.slow
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_it_with_status_0_and_nothing_left(number: signal.Signals) -> None:
    with service("one", "two") as started:
        pids = [row["pid"] for row in started.running("one", "two").values()]
        started.process.send_signal(number)
        assert started.process.wait(timeout=PATIENCE_S) == 0
        assert all_gone(pids)


@pytest.mark.slow
def test_a_killed_process_comes_back_and_the_others_go_on() -> None:
    with service("one", "two") as started:
        before = started.running("one", "two")
        os.kill(before["one"]["pid"], signal.SIGKILL)
        started.until(lambda table: table["one"]["restarts"] == 1)
        after = started.running("one", "two")
        assert after["one"]["pid"] != before["one"]["pid"]
        assert after["two"]["pid"] == before["two"]["pid"]
        assert after["two"]["restarts"] == 0


@pytest.mark.slow
def test_a_hung_process_is_killed_and_comes_back() -> None:
    with service("one") as started:
        before = started.running("one")["one"]["pid"]
        os.kill(before, signal.SIGSTOP)
        started.until(lambda table: table["one"]["restarts"] == 1)
        after = started.running("one")["one"]
        assert after["pid"] != before
        assert after["detail"] == "was killed because it did not answer"
        assert any("does not answer" in line for line in started.log)


@pytest.mark.slow
def test_a_process_that_keeps_crashing_is_disabled_and_that_is_said() -> None:
    with service("faller", "one") as started:
        table = started.until(lambda table: table["faller"]["state"] == "disabled")
        assert table["faller"]["detail"] == "5 crashes within a minute; the last time it ended with exit status 3"
        assert table["one"]["state"] == "running"


@pytest.mark.slow
def test_one_that_is_disabled_leaves_the_others_their_spares() -> None:
    with service("unborn", "one", "1") as started:
        table = started.until(lambda table: table["spare-1"]["state"] == "running")
        assert table["unborn"]["state"] == "disabled"
        assert "1 of 2 processes run" in started.log


@pytest.mark.slow
def test_a_process_that_ignores_sigterm_is_killed_in_time() -> None:
    with service("deaf") as started:
        pid = started.running("deaf")["deaf"]["pid"]
        started.process.send_signal(signal.SIGTERM)
        began = time.monotonic()
        assert started.process.wait(timeout=PATIENCE_S) == 0
        assert not is_alive(pid)
        assert time.monotonic() - began < PATIENCE_S


@pytest.mark.slow
def test_a_killed_supervisor_takes_its_processes_with_it() -> None:
    with service("one", "two", "2") as started:
        pids = [row["pid"] for row in started.running("one", "two", *SPARES).values()]
        started.process.kill()
        assert all_gone(pids)
        with pytest.raises(ServiceError, match="Connection refused"):
            attach_to(started.control)


@pytest.mark.slow
def test_the_others_wait_for_the_job_that_runs_once() -> None:
    with service("job", "one") as started:
        states = [row["job"]["state"] for row in [started.running("one")]]
        assert states == ["done"]
        assert "compiling: 1 of 1: nothing" in started.log
        assert "1 of 1 processes run" in started.log


@pytest.mark.slow
def test_the_others_are_started_after_a_job_that_may_fail_and_fails() -> None:
    with service("attempt", "one") as started:
        table = started.running("one")
        assert table["attempt"]["state"] == "disabled"
        assert "attempt ended with exit status 3: those that wait for it start without it" in started.log


@pytest.mark.slow
def test_one_that_waits_for_another_is_started_when_that_runs_or_has_crashed() -> None:
    with service("second", "first") as started:
        table = started.running("first", "second")
        assert table["second"]["pid"] > table["first"]["pid"]
    with service("patient", "unborn") as started:
        started.running("patient")


@pytest.mark.slow
def test_a_spare_takes_the_place_of_a_killed_process_and_is_replaced_itself() -> None:
    with service("one", "two", "2") as started:
        before = started.running("one", "two", *SPARES)
        os.kill(before["one"]["pid"], signal.SIGKILL)
        started.until(lambda table: table["one"]["restarts"] == 1)
        after = started.running("one", "two", *SPARES)
        assert after["one"]["pid"] == before["spare-1"]["pid"]
        assert after["one"]["detail"] == "ended with signal SIGKILL"
        assert after["two"] == before["two"]
        assert after["spare-1"]["pid"] != before["spare-1"]["pid"]
        assert after["spare-1"]["restarts"] == 0
        assert "spare-1 takes the place of one" in started.log
        assert os.sched_getscheduler(after["one"]["pid"]) & ~os.SCHED_RESET_ON_FORK == os.SCHED_OTHER
        assert os.sched_getscheduler(after["spare-1"]["pid"]) == os.SCHED_BATCH


@pytest.mark.slow
def test_a_spare_takes_the_place_of_a_hung_process() -> None:
    with service("one", "1") as started:
        before = started.running("one", "spare-1")
        os.kill(before["one"]["pid"], signal.SIGSTOP)
        started.until(lambda table: table["one"]["restarts"] == 1)
        assert started.running("one")["one"]["pid"] == before["spare-1"]["pid"]


@pytest.mark.slow
def test_when_all_spares_are_used_a_process_is_started_cold() -> None:
    names = ("one", "two", "three")
    with service(*names, "2") as started:
        before = started.running(*names, *SPARES)
        for name in names:
            os.kill(before[name]["pid"], signal.SIGKILL)
        started.until(lambda table: all(table[name]["restarts"] == 1 for name in names))
        after = started.running(*names)
        pids = {after[name]["pid"] for name in names}
        assert {before[spare]["pid"] for spare in SPARES} < pids
        started.running(*names, *SPARES)


@pytest.mark.slow
def test_a_spare_that_has_taken_a_place_ends_with_sigterm() -> None:
    with service("one", "1") as started:
        before = started.running("one", "spare-1")
        os.kill(before["one"]["pid"], signal.SIGKILL)
        started.until(lambda table: table["one"]["restarts"] == 1)
        pid = started.running("one")["one"]["pid"]
        started.process.send_signal(signal.SIGTERM)
        assert started.process.wait(timeout=PATIENCE_S) == 0
        assert all_gone([pid])


@pytest.mark.slow
def test_a_spare_that_keeps_dying_is_given_up_and_the_service_goes_on() -> None:
    with service("one", "1") as started:
        for ends in range(5):
            table = started.running("one", "spare-1")
            assert table["spare-1"]["restarts"] == ends
            pid = table["spare-1"]["pid"]
            os.kill(pid, signal.SIGKILL)
            started.until(lambda table, pid=pid: table["spare-1"]["pid"] != pid)
        os.kill(table["one"]["pid"], signal.SIGKILL)
        started.until(lambda table: table["one"]["restarts"] == 1)
        assert started.running("one")["spare-1"]["state"] == "disabled"


@pytest.mark.slow
def test_no_process_is_killed_when_the_whole_machine_stood_still() -> None:
    with service("one") as started:
        pid = started.running("one")["one"]["pid"]
        processes = started.process.pid, pid
        for process in processes:
            os.kill(process, signal.SIGSTOP)
        time.sleep(1.0)  # twice what a sleeper may be silent
        for process in processes:
            os.kill(process, signal.SIGCONT)
        began = time.monotonic()
        table = started.until(lambda _table: time.monotonic() - began > 1.0)
        assert (table["one"]["pid"], table["one"]["restarts"]) == (pid, 0)


@pytest.mark.slow
def test_a_process_that_waits_for_a_processor_is_not_hung() -> None:
    with service("one") as started:
        pid = started.running("one")["one"]["pid"]
        core = {min(os.sched_getaffinity(0))}
        os.sched_setaffinity(pid, core)
        os.sched_setscheduler(pid, os.SCHED_IDLE, os.sched_param(0))
        busy = [subprocess.Popen([sys.executable, "-c", BUSY.format(core=core)]) for _ in range(3)]
        began = time.monotonic()
        table = started.until(lambda _table: time.monotonic() - began > 3.0)
        for process in busy:
            process.kill()
            process.wait()
        assert (table["one"]["pid"], table["one"]["restarts"]) == (pid, 0)


@pytest.mark.slow
def test_a_process_that_computes_for_longer_than_its_heartbeat_may_take_is_left_to_work() -> None:
    with service("thinker") as started:
        pid = started.running("thinker")["thinker"]["pid"]
        attached = attach_to(started.control)
        heartbeats = attached.store.reader("heartbeat/thinker")
        started.until(lambda _table: heartbeats.sequence > 2)  # it has computed twice
        table = started.until(lambda _table: True)
        assert (table["thinker"]["pid"], table["thinker"]["restarts"]) == (pid, 0)
        attached.close()


@pytest.mark.slow
def test_a_process_that_computes_without_end_is_hung() -> None:
    with service("looper") as started:
        started.until(lambda table: table["looper"]["restarts"] == 1)
        assert any("looper does not answer" in line for line in started.log)


@pytest.mark.slow
def test_a_disabled_process_can_be_started_again() -> None:
    with service("faller", "one") as started:
        before = started.until(lambda table: table["faller"]["state"] == "disabled")["faller"]["restarts"]
        restart(started.control, "faller")
        started.until(lambda table: table["faller"]["restarts"] == before + 2)  # it was started, and has crashed again
        started.until(lambda table: table["faller"]["state"] == "disabled")
        with pytest.raises(ServiceError, match="restart one at .*not disabled; accepted: faller"):
            restart(started.control, "one")


@pytest.mark.slow
def test_the_database_can_be_read_from_outside() -> None:
    with service("one", "2") as started:
        table = started.running("one")
        attached = attach_to(started.control)
        assert attached.pid == started.process.pid
        beats = attached.store.reader("heartbeat/one")
        before = beats.sequence
        started.until(lambda _table: beats.sequence > before)
        reading = attached.store.reader("processes").read(MonotonicClock().now())
        assert reading is not None
        assert json.loads(reading.value)["processes"][0]["pid"] == table["one"]["pid"]
        assert attached.runs()
        started.process.send_signal(signal.SIGTERM)
        started.process.wait(timeout=PATIENCE_S)
        assert not attached.runs()
        attached.close()


@pytest.mark.slow
def test_nobody_reads_the_services_output_and_all_go_on() -> None:
    unread, output = os.pipe()
    with service("reader", "chatterbox", "one", stderr=output) as started:
        started.running("reader", "chatterbox", "one")
        until = time.monotonic() + 4.0  # 1.6 MB, far more than pipe and socket hold
        table = started.until(lambda table: time.monotonic() > until)
        assert {(row["state"], row["restarts"]) for row in table.values()} == {("running", 0)}
        started.process.send_signal(signal.SIGTERM)
        assert started.process.wait(timeout=PATIENCE_S) == 0
    os.close(unread)
    os.close(output)


@pytest.mark.slow
def test_what_processes_print_comes_out_as_whole_lines() -> None:
    printed, output = os.pipe()
    with service("reader", "speaker", stderr=output) as started:
        started.running("reader", "speaker")
        with os.fdopen(printed, "rb") as lines:
            assert {next(lines) for _ in range(3)} <= {b"a line\n", b"2 of 2 processes run\n"}
    os.close(output)


@pytest.mark.slow
def test_what_the_supervisor_says_comes_out_with_what_the_others_print_and_is_kept() -> None:
    printed, output = os.pipe()
    with service("reader", "one", stderr=output) as started:
        before = started.running("reader", "one")["one"]["pid"]
        os.kill(before, signal.SIGKILL)
        started.until(lambda table: table["one"]["restarts"] == 1)
        started.running("one")
        attached = attach_to(started.control)
        reader = LOG.reader(attached.store)
        started.until(lambda _table: "one ended" in str(reader.read(MonotonicClock().now())))
        kept = reader.value(MonotonicClock().now()).lines
        attached.close()
        started.process.send_signal(signal.SIGTERM)
        assert started.process.wait(timeout=PATIENCE_S) == 0
    os.close(output)
    with os.fdopen(printed) as pipe:
        lines = pipe.read().splitlines()
    ended = "one ended with signal SIGKILL: it is started again"
    assert ("supervisor", "warning", ended) in [(line.process, line.level, line.text) for line in kept]
    assert ended in lines
    assert lines[-1] == "stopped"


@pytest.mark.slow
def test_a_log_reader_that_stands_still_delays_no_supervisor_and_loses_no_last_words() -> None:
    printed, output = os.pipe()
    with service("reader", "one", stderr=output) as started:
        table = started.running("reader", "one")
        started.process.send_signal(signal.SIGTERM)
        os.kill(table["reader"]["pid"], signal.SIGSTOP)
        assert started.process.wait(timeout=PATIENCE_S) == 0
        assert started.process.stdout is not None
        started.log += started.process.stdout.read().splitlines()
    os.close(output)
    with os.fdopen(printed) as pipe:
        said = pipe.read().splitlines() + started.log
    assert said[-1] == "stopped"


@pytest.mark.slow
def test_the_supervisor_prints_by_itself_when_the_log_reader_is_given_up() -> None:
    with service("reader", "one") as started:
        for ends in range(5):
            table = started.until(
                lambda table, ends=ends: table["reader"]["state"] == "running" and table["reader"]["restarts"] == ends
            )
            os.kill(table["reader"]["pid"], signal.SIGKILL)
        table = started.until(lambda table: table["reader"]["state"] == "disabled")
        os.kill(table["one"]["pid"], signal.SIGKILL)
        started.until(lambda table: table["one"]["restarts"] == 1)
        assert any(line.startswith("one ended") for line in started.log)
