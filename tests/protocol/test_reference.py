"""docs/protocol.md says what the code does."""

import re
from pathlib import Path

import pytest

from vision_core.protocol.answers import decode_message
from vision_core.protocol.commands import COMMANDS, MAX_COMMAND, decode_commands
from vision_core.protocol.door import ALL_INITS_RATE
from vision_core.protocol.error_codes import ErrorCode
from vision_core.protocol.messages import MAX_LAG_S, REPORT_PERIOD_S, Init, InvalidCommand, See
from vision_core.protocol.options import MAX_DIRECTIONS, OPTION_PARSERS
from vision_core.protocol.rate_limits import COMMAND_RATE, DATAGRAM, RATES
from vision_core.protocol.session import LIMITED_ERRORS
from vision_core.types.edges import EDGE_TYPES, UNDEFINED, EdgeType, Letter

ROOT = Path(__file__).parents[2]
REFERENCE = (ROOT / "docs" / "protocol.md").read_text(encoding="utf-8")
ONE_LINE = " ".join(REFERENCE.split())


@pytest.mark.parametrize("word", [*ErrorCode])
def test_every_error_has_a_line(word: ErrorCode) -> None:
    assert REFERENCE.count(f"\n| `{word}` |") == 1


def test_every_option_has_a_line_and_the_lines_hold() -> None:
    shown = re.findall(r"^\| (`\(.*?) \| ", REFERENCE, flags=re.MULTILINE)
    assert {re.match(r"`\((\w+)", line)[1] for line in shown} == set(OPTION_PARSERS)  # type: ignore[index]
    for line in shown:
        for option in re.findall(r"`(\(.*?\))`", line):
            values = {"A B C": "4 0.0126 90000", " W": " 90", " C": " 10", " D": " 2", " N": " 5"}
            asked = option
            for name, value in values.items():
                asked = asked.replace(name, value)
            version = "(version 2) " if asked.startswith("(extra") else ""
            request = decode_commands(f"(init blue 3 {version}{asked})".encode())
            assert request is not None
            assert isinstance(request.commands[0], Init), asked


def test_reports_are_bounded_as_it_says() -> None:
    assert f"outside 0..{MAX_LAG_S * 1000:.0f} is ignored" in ONE_LINE
    assert "within half a second of your last report" in ONE_LINE
    assert REPORT_PERIOD_S == 0.5


def test_limits_are_as_it_says() -> None:
    init, other, datagram = RATES["init"], COMMAND_RATE, RATES[DATAGRAM]
    assert f"{init.burst} inits at once and {init.rate_hz:.0f} a second" in ONE_LINE
    assert f"every other command {other.burst} at once and {other.rate_hz:.0f} a second" in ONE_LINE
    assert f"together may send {ALL_INITS_RATE.rate_hz:.0f} inits a second" in ONE_LINE
    assert f"Above {datagram.burst} datagrams at once and {datagram.rate_hz:.0f} a second" in ONE_LINE
    assert ALL_INITS_RATE.burst == ALL_INITS_RATE.rate_hz


def test_every_command_is_named() -> None:
    assert all(f'"({command}"' in REFERENCE for command in COMMANDS)
    assert f"at most {MAX_DIRECTIONS}" in REFERENCE


def row_of(edge: EdgeType) -> str:
    """The line of the reference that an edge type must have."""

    def spelled(letter: Letter) -> str:
        last = chr(ord(letter.default) + letter.count - 1)
        return f"`{letter.default}`" if letter.count == 1 else f"`{letter.default}`..`{last}`: 1..{letter.count}"

    number = spelled(edge.number)
    if edge.numbered:
        number = f"{spelled(edge.numbered)}; {number}: its number is not known"
    names = ", ".join(letter.key for letter in edge.letters)
    return f"| {edge.meaning} ({names}) | {spelled(edge.same)} | {spelled(edge.team)} | {number} |"


def test_the_list_of_edge_types_is_the_table_of_edge_types() -> None:
    listed = re.findall(r"^\| edge \| .*?\n\| --- .*?\n(.*?)\n\n", REFERENCE, flags=re.MULTILINE | re.DOTALL)
    assert [rows.splitlines() for rows in listed] == [[row_of(edge) for edge in EDGE_TYPES]]
    assert f"`{UNDEFINED}` is no edge type" in REFERENCE


def test_messages_shown_are_legal() -> None:
    assert isinstance(decode_message(b"(see 20306.148 ((edge) w2cw2cw2d...-ff) ((ball) 61 121 3))"), See)
    for shown in re.findall(r"`(\((?:init|bye|lag|mirror) ?(?:blue|\(team blue|\d)[^`]*\))`", REFERENCE):
        request = decode_commands(shown.encode())
        assert request is None or not isinstance(request.commands[0], InvalidCommand), shown


def test_what_it_calls_silence_is_silence() -> None:
    said = re.search(r"answered with silence:\*\*(.*?)What begins with `\(` .*? as `(.*?)`", REFERENCE, flags=re.DOTALL)
    assert said is not None
    silent = re.findall(r"as\s+`(.+?)`", said[1])
    assert len(silent) == 2
    assert [decode_commands(datagram.encode()) for datagram in silent] == [None, None]
    assert f"more than {MAX_COMMAND} bytes" in said[1]
    request = decode_commands(said[2].encode())
    assert request is not None
    assert request.commands == (InvalidCommand(ErrorCode.ILLEGAL_FORM),)
    assert ErrorCode.ILLEGAL_FORM in LIMITED_ERRORS


def test_the_example_shown_is_the_one_that_runs() -> None:
    code = (ROOT / "examples" / "stdlib_client.py").read_text(encoding="utf-8")
    assert code[code.index("robot = socket.socket") :].rstrip() in REFERENCE
