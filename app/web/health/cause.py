"""One cause why robots are served worse than they should be, or not at all, and what to do about it."""

from dataclasses import dataclass
from enum import StrEnum


class Subject(StrEnum):
    """What a cause is about: the figure of the page's health strip that it belongs to."""

    SERVICE = "service"
    CAMERA = "camera"
    LAG = "lag"
    MISSES = "misses"
    DROPS = "drops"
    MACHINE = "machine"
    """How well the computer keeps time, and what the operating system grants."""


@dataclass(frozen=True, slots=True)
class Cause:
    """One cause, in words for people who run a match, and in words for those who maintain the service."""

    key: str
    """Names the cause, whatever numbers its text contains: the same cause has the same key in every snapshot."""
    about: Subject
    text: str
    """What is worse than it should be, in plain words."""
    advice: str
    """What to do, in a short sentence with its full stop."""
    detail: str = ""
    """The technical cause; empty: the text says all that is known."""
    hold_s: float = 0.0
    """Reported only when it has lasted this long [s]; 0: reported at once, and gone at once."""

    @property
    def sentence(self) -> str:
        """Text and detail in one line, without the advice."""
        return f"{self.text}: {self.detail}" if self.detail else self.text
