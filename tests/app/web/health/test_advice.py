"""Every cause that can occur says what to do: all places in the code that make one are found in the sources."""

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

from app.web.health.rights import GRANTED_BY
from tests.conftest import ROOT
from vision_core.rtdb.infos import RefusalKind

KINDS = {"Cause": 3, "Reason": 1, "_cause": 2, "_unknown": 2}
"""What makes a cause, and the place of its advice among the arguments; the last two are helpers."""
MAX_LENGTH = 130
FOLDERS = ("app/web", "vision_core")


def calls() -> Iterator[tuple[Path, ast.Module, ast.Call]]:
    """Every call in the sources that makes a cause or a reason."""
    for folder in FOLDERS:
        for path in sorted((ROOT / folder).rglob("*.py")):
            tree = ast.parse(path.read_text())
            for node in ast.walk(tree):
                if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in KINDS:
                    yield path, tree, node


CALLS = [pytest.param(*call, id=f"{call[0].stem}:{call[2].lineno}") for call in calls()]


def advice_of(call: ast.Call) -> ast.expr:
    """The argument that says what to do."""
    assert isinstance(call.func, ast.Name)
    return call.args[KINDS[call.func.id]]


def texts(value: ast.expr, tree: ast.Module) -> Iterator[str]:
    """What an expression can be, as far as it is written in the same module; ``{}`` for what is filled in."""
    if isinstance(value, ast.Constant):
        yield str(value.value)
    elif isinstance(value, ast.JoinedStr):
        yield "".join(str(part.value) if isinstance(part, ast.Constant) else "{}" for part in value.values)
    elif isinstance(value, ast.Name):
        for assigned in _assigned(value.id, tree):
            yield from texts(assigned, tree)
    elif isinstance(value, ast.Call) and isinstance(value.func, ast.Name):  # a function that finds the advice
        for function in ast.walk(tree):
            if isinstance(function, ast.FunctionDef) and function.name == value.func.id:
                for node in ast.walk(function):
                    if isinstance(node, ast.Return) and node.value:
                        yield from texts(node.value, tree)


def _assigned(name: str, tree: ast.Module) -> Iterator[ast.expr]:
    for node in ast.walk(tree):
        if isinstance(node, ast.Assign):
            for target in node.targets:
                if isinstance(target, ast.Name) and target.id == name:
                    yield node.value
                if isinstance(target, ast.Tuple) and isinstance(node.value, ast.Tuple):
                    pairs = zip(target.elts, node.value.elts, strict=True)
                    yield from (value for each, value in pairs if isinstance(each, ast.Name) and each.id == name)


@pytest.mark.parametrize(("path", "tree", "call"), CALLS)
def test_every_cause_says_what_to_do(path: Path, tree: ast.Module, call: ast.Call) -> None:
    for text in texts(advice_of(call), tree):
        assert text[:1].isupper() or text.startswith("{}"), (path, text)
        assert text.endswith("."), (path, text)
        assert len(text) <= MAX_LENGTH, (path, text)


def test_the_search_finds_them() -> None:
    assert len(CALLS) > 30
    found = [list(texts(advice_of(call), tree)) for _, tree, call in calls()]
    assert sum(bool(each) for each in found) > 25, "most are written where they are used; the rest is handed through"


@pytest.mark.parametrize("kind", RefusalKind)
def test_every_refusal_says_what_to_do(kind: RefusalKind) -> None:
    assert GRANTED_BY[kind].endswith(".")
