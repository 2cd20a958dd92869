"""Reads the grammar of docs/protocol.md: a pattern that recognizes its datagrams, and sentences that it makes.

    rule = name "=" choice      choice = row {"|" row}      row = part {part}
    part = name | "text" | "1".."16" | "{" choice "}" | "[" choice "]" | "(" choice ")"

No rule refers to itself, so the grammar is a regular expression over the words of a datagram.
"""

import random
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import NamedTuple, TypeAlias

_TOKEN = re.compile(r'"([^"]*)"|([A-Za-z]\w*)|(\.\.)|([][{}()|=])')
_WORD = re.compile(r"[()]|[^\s()]+")
CLOSING = {"{": "}", "[": "]", "(": ")"}


class Lexical(NamedTuple):
    """A word that the page describes in prose."""

    pattern: str
    samples: tuple[str, ...]


@dataclass(frozen=True)
class Text:
    words: tuple[str, ...]


@dataclass(frozen=True)
class Name:
    name: str


@dataclass(frozen=True)
class Row:
    parts: "tuple[Part, ...]"


@dataclass(frozen=True)
class Choice:
    rows: "tuple[Part, ...]"


@dataclass(frozen=True)
class Repeated:
    """Any number of times, or at most once."""

    part: "Part"
    sign: str


Part: TypeAlias = Text | Name | Row | Choice | Repeated


def words_of(text: str) -> tuple[str, ...]:
    """Parentheses and what stands between them and white space."""
    return tuple(_WORD.findall(text))


@dataclass(frozen=True)
class Grammar:
    rules: Mapping[str, Part]
    lexical: Mapping[str, Lexical]

    def undefined(self) -> set[str]:
        """Names without a rule: they must be described in prose."""
        return {name for rule in self.rules.values() for name in _names(rule)} - set(self.rules)

    def accepts(self, rule: str, text: str) -> bool:
        return re.fullmatch(self._pattern(self.rules[rule]), "".join(f"{word} " for word in words_of(text))) is not None

    def sentence(self, rule: str, rng: random.Random) -> str:
        words = " ".join(self._said(self.rules[rule], rng))
        return words.replace("( ", "(").replace(" )", ")")

    def _pattern(self, part: Part) -> str:
        match part:
            case Text(words):
                return "".join(f"{re.escape(word)} " for word in words)
            case Name(name) if name in self.lexical:
                return f"(?:{self.lexical[name].pattern}) "
            case Name(name):
                return self._pattern(self.rules[name])
            case Row(parts):
                return "".join(map(self._pattern, parts))
            case Choice(rows):
                return f"(?:{'|'.join(map(self._pattern, rows))})"
            case Repeated(inner, sign):
                return f"(?:{self._pattern(inner)}){sign}"

    def _said(self, part: Part, rng: random.Random) -> Iterator[str]:
        match part:
            case Text(words):
                yield from words
            case Name(name) if name in self.lexical:
                yield rng.choice(self.lexical[name].samples)
            case Name(name):
                yield from self._said(self.rules[name], rng)
            case Row(parts):
                for one in parts:
                    yield from self._said(one, rng)
            case Choice(rows):
                yield from self._said(rng.choice(rows), rng)
            case Repeated(inner, sign):
                for _ in range(rng.randint(0, 1 if sign == "?" else 3)):
                    yield from self._said(inner, rng)


def _names(part: Part) -> Iterator[str]:
    match part:
        case Name(name):
            yield name
        case Row(parts) | Choice(parts):
            for one in parts:
                yield from _names(one)
        case Repeated(inner):
            yield from _names(inner)


def read_rules(block: str) -> dict[str, Part]:
    """The rules of an indented block of the page. Raises ValueError for what is no grammar."""
    tokens = [match.group() for match in _TOKEN.finditer(block)]
    if "".join(tokens) != re.sub(r'\s+(?=(?:[^"]*"[^"]*")*[^"]*$)', "", block):
        raise ValueError(f"not a grammar: {block}")
    reader, rules = _Reader(tokens), {}
    while reader.left:
        name = reader.take()
        if reader.take() != "=" or name in rules:
            raise ValueError(f"rule {name}: a name, =, and its parts, once")
        rules[name] = reader.choice()
    return rules


class _Reader:
    def __init__(self, tokens: list[str]) -> None:
        self.left = tokens[::-1]

    def take(self) -> str:
        return self.left.pop()

    def choice(self) -> Part:
        rows = [self._row()]
        while self.left and self.left[-1] == "|":
            self.take()
            rows.append(self._row())
        return Choice(tuple(rows)) if len(rows) > 1 else rows[0]

    def _row(self) -> Part:
        parts = []
        while self.left and self.left[-1] not in ("|", *CLOSING.values()) and self.left[-2:-1] != ["="]:
            parts.append(self._part())
        return Row(tuple(parts))

    def _part(self) -> Part:
        token = self.take()
        if token in CLOSING:
            inner = self.choice()
            if self.take() != CLOSING[token]:
                raise ValueError(f"{token} without {CLOSING[token]}")
            return inner if token == "(" else Repeated(inner, "*" if token == "{" else "?")
        if not token.startswith('"'):
            return Name(token)
        if self.left and self.left[-1] == "..":
            self.take()
            first, last = int(token.strip('"')), int(self.take().strip('"'))
            return Choice(tuple(Text((str(number),)) for number in range(first, last + 1)))
        return Text(words_of(token.strip('"')))
