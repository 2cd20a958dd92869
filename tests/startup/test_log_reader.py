"""What the processes print: whole lines, a share for each process, and nobody waits."""

import os
import socket
import subprocess
import sys
from collections.abc import Iterator

import pytest

from vision_core.clock import Instant, after
from vision_core.startup.log_book import LogBook
from vision_core.startup.log_reader import MAX_LINE, MAX_LINES, PERIOD_S, LogReader
from vision_core.startup.process_names import unnamed

NOW = Instant(1_000_000_000)
LATER = after(NOW, PERIOD_S + 0.1)


class Printing:
    """A reader, the end at which processes print, and the pipe where it comes out."""

    def __init__(self) -> None:
        source, self.output = socket.socketpair()
        self.printed, self.descriptor = os.pipe()
        os.set_blocking(self.printed, False)
        self.output.setblocking(False)
        self.book = LogBook()
        self.reader = LogReader(source, self.descriptor, self.book, unnamed)
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


def test_what_is_printed_is_kept_also_when_nobody_reads_it(printing: Printing) -> None:
    line = b"z" * 999 + b"\n"
    for _ in range(MAX_LINES - 1):
        printing.output.send(line)
        printing.read_all()
    printing.output.send(b"the last one\n" * 3)
    printing.read_all()
    log = printing.book.record()
    assert {kept.process for kept in log.lines} == {f"process {os.getpid()}"}
    assert [kept.times for kept in log.lines] == [MAX_LINES - 1, 1]
    assert log.lines[1].text == "the last one"
    assert log.left_out == 2


def test_what_a_stranger_sent_does_nothing_to_who_reads_it(printing: Printing) -> None:
    printing.output.send("\x1b[2J\x07up\r\x00\x9b31m \u202egnorw \xe9\u2028\n".encode() + b"\xff\xfe\n")
    printing.read_all()
    first, second = printing.lines()
    assert first.decode() == r"\x1b[2J\x07up\r\x00\x9b31m \u202egnorw é\u2028"
    assert second == rb"\xff\xfe"
    assert [line.text for line in printing.book.record().lines] == [first.decode(), second.decode()]


def test_it_ends_when_nobody_can_print_any_more(printing: Printing) -> None:
    printing.output.send(b"last words\n")
    printing.output.close()
    printing.read_all()
    assert printing.reader.has_ended
    assert printing.lines() == [b"last words"]


def test_a_reader_that_stands_still_loses_lines_and_stops_no_writer(printing: Printing) -> None:
    script = "for _ in range(2000): print('w' * 999)"
    environment = os.environ | {"PYTHONUNBUFFERED": "1"}
    done = subprocess.run(
        [sys.executable, "-c", script], stdout=printing.output.fileno(), env=environment, timeout=30, check=False
    )
    assert done.returncode == 0
