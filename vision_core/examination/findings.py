"""What an examination finds, in words."""

import json
from collections.abc import Iterable
from dataclasses import asdict, dataclass
from enum import IntEnum
from typing import TextIO


class Grade(IntEnum):
    """How it is; its value is the command's exit status."""

    GOOD = 0
    DOUBTFUL = 1
    BAD = 2


@dataclass(frozen=True, slots=True)
class Finding:
    """One line of a report."""

    name: str
    grade: Grade
    sentence: str


def good(name: str, sentence: str) -> Finding:
    """It is as it should be."""
    return Finding(name, Grade.GOOD, sentence)


def doubtful(name: str, sentence: str) -> Finding:
    """One can play, but should know this."""
    return Finding(name, Grade.DOUBTFUL, sentence)


def bad(name: str, sentence: str) -> Finding:
    """It does not work."""
    return Finding(name, Grade.BAD, sentence)


def worst(findings: Iterable[Finding]) -> Grade:
    """The worst grade; GOOD if nothing was found."""
    return max((finding.grade for finding in findings), default=Grade.GOOD)


def print_finding(finding: Finding, out: TextIO, *, as_json: bool) -> None:
    """One line: JSON, or grade, name and sentence."""
    if as_json:
        line = json.dumps({**asdict(finding), "grade": finding.grade.name.lower()})
    else:
        line = f"{finding.grade.name.lower():<9} {finding.name:<16} {finding.sentence}"
    print(line, file=out, flush=True)
