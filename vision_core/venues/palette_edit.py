"""Writes the color samples of a class into a settings file, and leaves everything else in it as it is."""

import json
import re
import tomllib
from collections.abc import Mapping, Sequence
from pathlib import Path

from vision_core.errors import SettingsError
from vision_core.venues.toml_edit import ANY_HEADER, assignment, replace_file

BARE_KEY = re.compile(r"[A-Za-z0-9_-]+")
HEADER = re.compile(r"^\s*\[\s*colors\s*\.\s*samples\s*\]")


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
    replace_file(path, edited, f"--save to {path}")


def _edited(text: str, samples: Mapping[str, Sequence[str]], name: str) -> str:
    lines = text.splitlines()
    headers = [number for number, line in enumerate(lines) if HEADER.match(line)]
    if not headers:
        gap = [""] if lines and lines[-1].strip() else []
        return "\n".join([*lines, *gap, sample_table(samples), ""])
    start = headers[0] + 1
    end = next((number for number in range(start, len(lines)) if ANY_HEADER.match(lines[number])), len(lines))
    first, last = assignment(lines, start, end, name)
    return "\n".join([*lines[:first], sample_line(name, samples[name]), *lines[last:], ""])
