"""Writes the color samples of a class into a settings file, and leaves everything else in it as it is."""

import json
import re
import tomllib
from collections.abc import Mapping, Sequence
from pathlib import Path

from vision_core.errors import SettingsError

BARE_KEY = re.compile(r"[A-Za-z0-9_-]+")
HEADER = re.compile(r"^\s*\[\s*colors\s*\.\s*samples\s*\]")
ANY_HEADER = re.compile(r"^\s*\[")


def sample_line(name: str, colors: Sequence[str]) -> str:
    """A class and its samples as a line of TOML; colors: "#rrggbb"."""
    key = name if BARE_KEY.fullmatch(name) else json.dumps(name, ensure_ascii=False)
    return f"{key} = [{', '.join(json.dumps(color) for color in colors)}]"


def sample_table(samples: Mapping[str, Sequence[str]]) -> str:
    """All classes as the table ``[colors.samples]``."""
    return "\n".join(["[colors.samples]", *(sample_line(name, colors) for name, colors in samples.items())])


def save_samples(path: Path, text: str, samples: Mapping[str, Sequence[str]], name: str) -> None:
    """Write the samples of one class into a settings file.

    text: the file's content; samples: those of all classes, which are written when the file has no table of them yet.
    The file is replaced in one step. Raises SettingsError when its table is written in a form that cannot be edited, or
    the file cannot be written.
    """
    edited = _edited(text, samples, name)
    try:
        saved = tomllib.loads(edited)["colors"]["samples"].get(name)
    except (ValueError, KeyError, AttributeError):
        saved = None
    if saved != list(samples[name]):
        accepted = (
            f"a table [colors.samples] with one class per line; write into it: {sample_line(name, samples[name])}"
        )
        raise SettingsError(f"--save to {path}", found="colors.samples in another form", accepted=accepted)
    beside = path.with_name(f".{path.name}.new")
    try:
        beside.write_text(edited, encoding="utf-8")
        beside.chmod(path.stat().st_mode)
        beside.replace(path)
    except OSError as error:
        beside.unlink(missing_ok=True)
        found = error.strerror or str(error)
        raise SettingsError(f"--save to {path}", found=found, accepted="a file that may be written") from None


def _edited(text: str, samples: Mapping[str, Sequence[str]], name: str) -> str:
    lines = text.splitlines()
    headers = [number for number, line in enumerate(lines) if HEADER.match(line)]
    if not headers:
        gap = [""] if lines and lines[-1].strip() else []
        return "\n".join([*lines, *gap, sample_table(samples), ""])
    start = headers[0] + 1
    end = next((number for number in range(start, len(lines)) if ANY_HEADER.match(lines[number])), len(lines))
    first, last = _assignment(lines, start, end, name)
    return "\n".join([*lines[:first], sample_line(name, samples[name]), *lines[last:], ""])


def _assignment(lines: list[str], start: int, end: int, name: str) -> tuple[int, int]:
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
