"""Why something is not as it should be, and what to do about it: made together, at one place."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Reason:
    """One reason for people, with its remedy."""

    text: str
    """What is wrong, in plain words: no capital, no full stop."""
    advice: str
    """What to do, in a short sentence with its full stop."""
    explains: float = 0.0
    """How many robots are not read, or not rightly, because of it; inf: nothing can be seen because of it."""
    is_calibration: bool = False
    """It is the calibration that is wrong: what is read is somewhere else."""

    def __str__(self) -> str:
        """Both in one line."""
        return f"{self.text}. {self.advice}"
