"""The kept lines: what they mean, and that they never become too many or too large."""

import msgspec
import pytest

from vision_core.rtdb.log_record import LOG, MAX_LOG, LogLevel, ServiceLog
from vision_core.startup.log_book import CUT, MAX_LINES, MAX_TEXT, LogBook, level_of

LEVELS = {
    "error: no camera": LogLevel.ERROR,
    "uvicorn.error: ready to serve": LogLevel.INFO,
    "web: ERROR: Exception in ASGI application": LogLevel.ERROR,
    "not ready: no picture has come for 2 s": LogLevel.ERROR,
    "compile (prepares) ended with exit status 1: the service cannot start": LogLevel.ERROR,
    "spare-1: nearest cannot be loaded: ImportError()": LogLevel.ERROR,
    "5 crashes within a minute: it stays off; pslv restart x starts it again": LogLevel.ERROR,
    "perceive (finds robots) ended with signal SIGKILL: it is started again": LogLevel.WARNING,
    "perceive ended with exit status 1: it is started again in 0.25 s": LogLevel.WARNING,
    "perceive (finds robots) does not answer and is killed": LogLevel.WARNING,
    "degraded: views may be late": LogLevel.WARNING,
    "ready but degraded: views may be late": LogLevel.WARNING,
    "SCHED_FIFO 45 is refused: no CAP_SYS_NICE": LogLevel.WARNING,
    "12 more lines in 10 s were left out": LogLevel.WARNING,
    "people.db is damaged (file is not a database) and is kept": LogLevel.WARNING,
    "ready": LogLevel.INFO,
    "10 of 10 processes run": LogLevel.INFO,
    "spare-1 takes the place of perceive": LogLevel.INFO,
    "stopped": LogLevel.INFO,
}


@pytest.mark.parametrize("text", LEVELS)
def test_a_line_has_the_level_that_its_words_say(text: str) -> None:
    assert level_of(text) is LEVELS[text]


def test_a_traceback_is_an_error_to_its_end_and_others_in_between_are_not() -> None:
    book = LogBook()
    book.add("serve", "Traceback (most recent call last):", 1.0)
    book.add("serve", '  File "serve.py", line 7, in run', 1.0)
    book.add("web", "ready", 1.0)
    book.add("serve", "    1 / 0", 1.0)
    book.add("serve", "ZeroDivisionError: division by zero", 1.0)
    book.add("serve", "starts", 2.0)
    levels = [line.level.value for line in book.record().lines]
    assert levels == ["error", "error", "info", "error", "error", "info"]


def test_a_repeated_line_is_counted_and_has_the_newest_time() -> None:
    book = LogBook()
    for at in (1.0, 2.0, 3.0):
        book.add("web", "the same", at)
    book.add("serve", "the same", 4.0)
    assert [(line.number, line.at, line.times) for line in book.record().lines] == [(1, 3.0, 3), (2, 4.0, 1)]


def test_the_name_of_the_process_is_not_told_twice_and_nothing_is_no_line() -> None:
    book = LogBook()
    book.add("web", "web: ready", 1.0)
    book.add("web", "   ", 1.0)
    assert [line.text for line in book.record().lines] == ["ready"]


def test_a_long_line_is_cut() -> None:
    book = LogBook()
    book.add("web", "x" * (MAX_TEXT + 1), 1.0)
    book.add("web", "y" * MAX_TEXT, 1.0)
    assert [line.text for line in book.record().lines] == ["x" * (MAX_TEXT - 1) + CUT, "y" * MAX_TEXT]


def test_it_fits_into_its_record_whatever_is_printed() -> None:
    book = LogBook()
    for number in range(3 * MAX_LINES):
        book.add("w" * 15, f"{number} " + "\U0001f916" * MAX_TEXT, 1e9)
        assert len(LOG.encode(book.record())) <= MAX_LOG
    log = book.record()
    assert log.lines[-1].number == 3 * MAX_LINES
    assert len(log.lines) + log.older == 3 * MAX_LINES


def test_who_prints_much_pushes_only_his_own_lines_out() -> None:
    book = LogBook()
    book.add("supervisor", "perceive ended: it is started again", 1.0)
    for number in range(2 * MAX_LINES):
        book.add("perceive", f"line {number}", 2.0)
    log = book.record()
    assert len(log.lines) == MAX_LINES
    assert log.lines[0].process == "supervisor"
    assert log.lines[1].text == f"line {MAX_LINES + 1}"
    assert log.older == MAX_LINES + 1


def test_there_is_news_until_it_is_told() -> None:
    book = LogBook()
    assert not book.has_news
    book.leave_out()
    assert book.has_news
    assert book.record() == ServiceLog((), 1, 0)
    assert not book.has_news


def test_a_reader_that_is_started_again_goes_on() -> None:
    book = LogBook()
    book.leave_out()
    for number in range(MAX_LINES + 5):
        book.add("web", f"line {number}", 1.0)
    kept = msgspec.msgpack.decode(LOG.encode(book.record()), type=ServiceLog)
    after = LogBook(kept)
    after.add("web", "the next", 2.0)
    log = after.record()
    assert log.lines[-1].number == MAX_LINES + 6
    assert (len(log.lines), log.older, log.left_out) == (MAX_LINES, 6, 1)
