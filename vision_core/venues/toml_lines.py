"""The line of a TOML file that sets a key, for messages: the parser does not keep it."""

import re
from collections.abc import Sequence

_HEADER = re.compile(r"^\s*\[\[?\s*([^\]]+?)\s*\]\]?")
_KEY = re.compile(r"^\s*((?:[\w-]+|\"[^\"]*\")(?:\s*\.\s*(?:[\w-]+|\"[^\"]*\"))*)\s*=")


def line_of(text: str, keys: Sequence[str]) -> int | None:
    """Number of the line, from 1, that sets a key, or the nearest of its parents; None when none of them is set.

    text: a valid TOML file; keys: the path to a value. For a key inside a value (a table in braces, a list) it is the
    line where that value begins.
    """
    found, depth, table = None, 0, []
    for number, line in enumerate(text.splitlines(), start=1):
        if header := _HEADER.match(line):
            table = path = _split(header.group(1))
        elif key := _KEY.match(line):
            path = [*table, *_split(key.group(1))]
        else:
            continue
        if len(path) > depth and list(keys[: len(path)]) == path:
            found, depth = number, len(path)
    return found


def _split(dotted: str) -> list[str]:
    return [part.strip().strip('"') for part in dotted.split(".")]
