"""One cause of worse service while robots are served."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Degradation:
    """One cause, in words for people who run a match, and in words for those who maintain the service."""

    key: str
    """Names the cause, whatever numbers its text contains: the same cause has the same key in every snapshot."""
    text: str
    """What is worse than it should be, in plain words."""
    detail: str = ""
    """The technical cause; empty: the text says all that is known."""
    hold_s: float = 0.0
    """Reported only when it has lasted this long [s]; 0: reported at once, and gone at once."""

    @property
    def sentence(self) -> str:
        """Text and detail in one line."""
        return f"{self.text}: {self.detail}" if self.detail else self.text
