"""What a rule of the settings reports."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Violation:
    """A rule that does not hold: the key that breaks it, what was found there, what would be accepted."""

    key: str
    found: str
    accepted: str
