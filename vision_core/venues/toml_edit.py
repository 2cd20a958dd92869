"""Sets keys in the text of a settings file, and leaves everything else in it as it is."""

import re
import tomllib
from collections.abc import Mapping
from pathlib import Path

from vision_core.errors import SettingsError

ANY_HEADER = re.compile(r"^\s*\[")


def with_values(text: str, table: str, values: Mapping[str, str]) -> str:
    """A file's text with some keys of a table set; the table is appended when the file has none.

    table: its name as in the header, "camera.pinhole"; values: by key, as they are written in TOML. A comment at the
    end of a line stays.
    """
    lines = text.splitlines()
    header = _header(table)
    found = [number for number, line in enumerate(lines) if header.match(line)]
    if not found:
        gap = [""] if lines and lines[-1].strip() else []
        added = [f"{key} = {value}" for key, value in values.items()]
        return "\n".join([*lines, *gap, f"[{table}]", *added, ""])
    start = found[0] + 1
    for key, value in values.items():
        end = next((number for number in range(start, len(lines)) if ANY_HEADER.match(lines[number])), len(lines))
        first, last = assignment(lines, start, end, key)
        comment = _comment(lines[first]) if last == first + 1 else ""
        lines[first:last] = [f"{key} = {value}{comment}"]
    return "\n".join([*lines, ""])


def without_table(text: str, table: str) -> str:
    """A file's text without a table that has a header of its own, and without the comments in it."""
    lines = text.splitlines()
    header = _header(table)
    start = next((number for number, line in enumerate(lines) if header.match(line)), None)
    if start is None:
        return text
    end = next((number for number in range(start + 1, len(lines)) if ANY_HEADER.match(lines[number])), len(lines))
    return "\n".join([*lines[:start], *lines[end:], ""])


def _header(table: str) -> re.Pattern[str]:
    """What the header of a table looks like."""
    name = r"\s*\.\s*".join(map(re.escape, table.split(".")))
    return re.compile(rf"^\s*\[\s*{name}\s*\]")


def assignment(lines: list[str], start: int, end: int, name: str) -> tuple[int, int]:
    """The lines [first, last) that set a key of a table; an empty range at the table's end when none does."""
    table_end = start
    for first in range(start, end):
        for last in range(first + 1, end + 1):
            try:
                table = tomllib.loads("\n".join(lines[first:last]))
            except tomllib.TOMLDecodeError:
                continue  # a list that goes on in the next line
            if name in table:
                return first, last
            table_end = last if table else table_end
            break
    return table_end, table_end


def replace_file(path: Path, text: str, asked: str) -> None:
    """Replace a file's content in one step; it keeps its rights. Raises SettingsError when it cannot be written."""
    beside = path.with_name(f".{path.name}.new")
    try:
        beside.write_text(text, encoding="utf-8")
        beside.chmod(path.stat().st_mode)
        beside.replace(path)
    except OSError as error:
        beside.unlink(missing_ok=True)
        found = error.strerror or str(error)
        raise SettingsError(asked, found=found, accepted="a file that may be written") from None


def _comment(line: str) -> str:
    """The comment at the end of a line that sets a key, with the blanks before it; empty when it has none."""
    for match in re.finditer(r"\s*#", line):
        try:
            tomllib.loads(line[: match.start()])
        except tomllib.TOMLDecodeError:
            continue  # a number sign inside a string
        return line[match.start() :]
    return ""
