"""A rule that a server keeps, breaks, or cannot be held to now."""

from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum

from vision_core.examination.conformance.probe import Probe


class Verdict(StrEnum):
    """How it went."""

    PASSED = "passed"
    FAILED = "failed"
    SKIPPED = "skipped"


@dataclass(frozen=True, slots=True)
class Rule:
    """A sentence of docs/protocol.md, and how to see that a server keeps to it."""

    name: str
    sentence: str
    """Word for word, but for line breaks."""
    hold: Callable[[Probe], None]
    """Plays a client. Raises Broken or Skipped of ``probe``."""


@dataclass(frozen=True, slots=True)
class Outcome:
    """What came out for one rule."""

    rule: Rule
    verdict: Verdict
    why: str
    """What was expected and what came; empty: passed."""
    exchange: tuple[str, ...]
    """Every datagram, as ``-> (init blue 1)``."""


class RuleBook:
    """Collects the rules of a module."""

    def __init__(self) -> None:
        self.rules: list[Rule] = []

    def rule(self, sentence: str) -> Callable[[Callable[[Probe], None]], Callable[[Probe], None]]:
        """Makes a rule of a function; its name is the function's."""

        def added(hold: Callable[[Probe], None]) -> Callable[[Probe], None]:
            self.rules.append(Rule(hold.__name__.replace("_", "-"), sentence, hold))
            return hold

        return added
