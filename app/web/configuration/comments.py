"""What the shipped settings files say about each setting: the comments beside their keys."""

import re
from collections.abc import Iterator
from functools import cache

from vision_core.venues.loader import config_folder

FILES = ("fields/ssl-2002.toml", "default.toml")
"""A comment of a later file replaces one of an earlier file."""
_HEADER = re.compile(r"^\[\s*([\w.-]+)\s*\]\s*(?:#\s*(.*))?$")
_KEY = re.compile(r"^([\w-]+)\s*=\s*([^#]*?)\s*(?:#\s*(.*))?$")
_CONTINUED = re.compile(r"^\s+#\s*(.*)$")


@cache
def comments() -> dict[str, str]:
    """The comment of each setting by its dotted key, and that of each table by its name."""
    found: dict[str, str] = {}
    for name in FILES:
        found |= dict(_comments_of((config_folder() / name).read_text(encoding="utf-8")))
    return found


def _comments_of(text: str) -> Iterator[tuple[str, str]]:
    table, key, words = "", "", ""
    for line in text.splitlines():
        if key and (more := _CONTINUED.match(line)):
            words = f"{words} {more.group(1)}"
            continue
        if key and words:
            yield key, words
        key, words = "", ""
        if header := _HEADER.match(line):
            table = key = header.group(1)
            words = header.group(2) or ""
        elif entry := _KEY.match(line):
            key = f"{table}.{entry.group(1)}" if table else entry.group(1)
            words = entry.group(3) or ""
    if key and words:
        yield key, words
