"""What the processes print: whole lines, a share for each process, and nobody waits."""

import os
import socket
import subprocess
import sys
from collections.abc import Iterator

import pytest

from vision_core.clock import Instant, after
from vision_core.startup.log_reader import MAX_LINE, MAX_LINES, PERIOD_S, LogReader

NOW = Instant(1_000_000_000)
LATER = after(NOW, PERIOD_S + 0.1)


class Printing:
    """A reader, the end at which processes print, and the pipe where it comes out."""

    def __init__(self) -> None:
        source, self.output = socket.socketpair()
        self.printed, self.descriptor = os.pipe()
        os.set_blocking(self.printed, False)
        self.output.setblocking(False)
        self.reader = LogReader(source, self.descriptor)
        self.source = source

    def read_all(self, now: Instant = NOW) -> None:
        while self.reader.read(0.0, now):
            pass

    def lines(self) -> list[bytes]:
        try:
            return os.read(self.printed, 1 << 20).splitlines()
        except BlockingIOError:
            return []

    def close(self) -> None:
        self.source.close()
        self.output.close()
        os.close(self.printed)
        os.close(self.descriptor)


@pytest.fixture
def printing() -> Iterator[Printing]:
    made = Printing()
    yield made
    made.close()


def test_a_line_comes_out_when_it_is_whole(printing: Printing) -> None:
    printing.output.send(b"first\nthe next ")
    printing.read_all()
    assert printing.lines() == [b"first"]
    printing.output.send(b"line\n")
    printing.read_all()
    assert printing.lines() == [b"the next line"]


def test_lines_of_two_processes_do_not_mix(printing: Printing) -> None:
    printing.output.send(b"ours, ")
    subprocess.run([sys.executable, "-c", "print('theirs')"], stdout=printing.output.fileno(), check=True)
    printing.output.send(b"whole\n")
    printing.read_all()
    assert printing.lines() == [b"theirs", b"ours, whole"]


def test_a_process_has_its_share_and_what_is_left_out_is_counted(printing: Printing) -> None:
    printing.output.send(b"x\n" * (MAX_LINES + 7))
    printing.read_all()
    assert printing.lines() == [b"x"] * MAX_LINES
    printing.read_all(LATER)
    assert printing.lines() == [f"7 more lines of process {os.getpid()} were left out".encode()]
    printing.output.send(b"again\n")
    printing.read_all(LATER)
    assert printing.lines() == [b"again"]


def test_a_line_without_end_is_printed_in_pieces_or_after_a_while(printing: Printing) -> None:
    printing.output.send(b"y" * (MAX_LINE + 5))
    printing.read_all()
    assert printing.lines() == [b"y" * MAX_LINE]
    printing.read_all(LATER)
    assert printing.lines() == [b"yyyyy"]


def test_who_does_not_read_delays_nobody(printing: Printing) -> None:
    line = b"z" * 999 + b"\n"
    for _ in range(MAX_LINES):
        printing.output.send(line)
        printing.read_all()
    assert 0 < len(printing.lines()) < MAX_LINES
    printing.reader.end()
    assert printing.lines()[-1].endswith(b"were left out")


def test_a_reader_that_stands_still_loses_lines_and_stops_no_writer(printing: Printing) -> None:
    script = "for _ in range(2000): print('w' * 999)"
    environment = os.environ | {"PYTHONUNBUFFERED": "1"}
    done = subprocess.run(
        [sys.executable, "-c", script], stdout=printing.output.fileno(), env=environment, timeout=30, check=False
    )
    assert done.returncode == 0
