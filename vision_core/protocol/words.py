"""Words that datagrams of both sides share: team, number, Time, counters."""

import re

from vision_core.clock import US_PER_S
from vision_core.protocol.messages import MAX_NUMBER
from vision_core.protocol.s_expressions import Form, integer
from vision_core.types.objects import Team

TIME = re.compile(rb"([0-9]{1,10})(?:\.([0-9]{0,6})[0-9]*)?")
"""Time as it is printed: seconds, and up to six decimals that count."""
NAME = re.compile(r"[a-z_]{1,39}")
"""A name of a mode, an error or a warning."""
_LONG = re.compile(r"-?[0-9]{1,19}")
_TEAMS = {team.value: team for team in Team}


def team_of(word: str | Form) -> Team | None:
    """The team of a word."""
    return _TEAMS.get(word) if isinstance(word, str) else None


def number_of(word: str | Form) -> int | None:
    """The robot's number of a word, 1..16."""
    number = integer(word)
    return number if number is not None and 1 <= number <= MAX_NUMBER else None


def long_integer(word: str | Form) -> int | None:
    """The value of a decimal integer that fits into 64 bits."""
    number = int(word) if isinstance(word, str) and _LONG.fullmatch(word) else None
    return number if number is not None and -(2**63) <= number < 2**63 else None


def time_us(seconds: bytes, decimals: bytes | None) -> int:
    """Time [us] from the groups of TIME."""
    return int(seconds) * US_PER_S + int((decimals or b"").ljust(6, b"0"))
