"""S-expressions: text -> nested tuples of words, without recursion, with bounded depth and number of forms.

Words are read in any letter case, but for the one after ``key``: a team's key is random text.
"""

import re
from typing import TypeAlias, Union

SPACE = b" \t\r\n\v\f"
MAX_DEPTH = 3
"""Of nested forms, as in ``(a (b (c)))``."""
MAX_FORMS = 16
"""In one datagram: a form for each robot of a team."""

Form: TypeAlias = tuple[Union[str, "Form"], ...]

_LEGAL = re.compile(rb"[\t-\r -~]*")
_TOKENS = re.compile(r"[()]|[^\s()]+")
_INTEGER = re.compile(r"0|-?[1-9][0-9]{0,8}")
_REAL = re.compile(r"[+-]?(?:[0-9]{1,20}(?:\.[0-9]{0,20})?|\.[0-9]{1,20})(?:[eE][+-]?[0-9]{1,3})?")


def parse_forms(body: bytes) -> tuple[Form, ...] | None:
    """The 1 to 16 forms of a datagram, in lower case but for keys; None when there is a mistake in them."""
    if not _LEGAL.fullmatch(body):
        return None
    done: list[Form] = []
    open_forms: list[list[str | Form]] = []
    for match in _TOKENS.finditer(body.decode("ascii")):
        word = match.group()
        if word == "(":
            if len(open_forms) == MAX_DEPTH or len(done) == MAX_FORMS:
                return None
            open_forms.append([])
        elif not open_forms:
            return None
        elif word == ")":
            form = tuple(open_forms.pop())
            (open_forms[-1] if open_forms else done).append(form)
        else:
            open_forms[-1].append(word if open_forms[-1] == ["key"] else word.lower())
    return tuple(done) if done and not open_forms else None


def integer(word: "str | Form") -> int | None:
    """The value of a decimal integer without a sign + or leading zeros; None for anything else."""
    return int(word) if isinstance(word, str) and _INTEGER.fullmatch(word) else None


def real(word: "str | Form") -> float | None:
    """The value of a decimal number; None for anything else, as nan, inf, 1_000."""
    return float(word) if isinstance(word, str) and _REAL.fullmatch(word) else None
