"""Why something is not as it should be, and what to do about it: made together, at one place."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Reason:
    """One reason for people, with its remedy."""

    text: str
    """What is wrong, in plain words: no capital, no full stop."""
    advice: str
    """What to do, in a short sentence with its full stop."""

    def __str__(self) -> str:
        """Both in one line."""
        return f"{self.text}. {self.advice}"
