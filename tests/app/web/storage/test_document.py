"""Entries with history, undo, redo and conflicts."""

from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.web.storage.document import ConflictError, Document, Kind, NothingToUndoError


@pytest.fixture
def document(tmp_path: Path) -> Document:
    return Document(tmp_path / "venue.db")


def put(document: Document, seen: int | None = None, **values: Any) -> None:
    document.change(values, who="Ada", what="a test", seen=seen)


def test_a_change_has_who_when_what_before_and_after(document: Document) -> None:
    put(document, side="left")
    change = document.change({"side": "right", "mode": "match"}, who="Ada", what="start the match")
    assert change is not None
    assert (change.revision, change.who, change.what, change.kind) == (2, "Ada", "start the match", Kind.CHANGE)
    assert [(e.key, e.before, e.after) for e in change.entries] == [("mode", None, "match"), ("side", "left", "right")]
    assert document.history(10)[0] == change


def test_none_deletes_an_entry(document: Document) -> None:
    put(document, side="left")
    put(document, side=None)
    assert document.entries() == {}


def test_a_change_that_changes_nothing_makes_no_revision(document: Document) -> None:
    put(document, side="left")
    assert document.change({"side": "left"}, who="Ada", what="again") is None
    assert document.revision == 1


def test_everything_is_there_after_a_restart(document: Document, tmp_path: Path) -> None:
    put(document, team={"name": "Köln", "robots": [1, 2]})
    document.close()
    again = Document(tmp_path / "venue.db")
    assert again.entries() == {"team": {"name": "Köln", "robots": [1, 2]}}
    assert again.undoable() is not None


def test_undo_and_redo(document: Document) -> None:
    put(document, side="left")
    put(document, side="right")
    assert document.undo(who="Bob", seen=2).what == "undo: a test"
    assert document.entries() == {"side": "left"}
    document.redo(who="Bob", seen=3)
    assert document.entries() == {"side": "right"}
    document.undo(who="Bob", seen=4)
    document.undo(who="Bob", seen=5)
    assert document.entries() == {}
    with pytest.raises(NothingToUndoError):
        document.undo(who="Bob", seen=6)


def test_a_new_change_ends_what_could_be_redone(document: Document) -> None:
    put(document, side="left")
    document.undo(who="Ada", seen=1)
    put(document, mode="match")
    assert document.redoable() is None


def test_what_the_service_changed_by_itself_is_not_undone(document: Document) -> None:
    put(document, side="left")
    document.change({"admission": None, "other": 1}, who="PSLV", what="it has ended", kind=Kind.SERVICE)
    undone = document.undo(who="Ada", seen=2)
    assert undone.of == 1
    assert document.entries() == {"other": 1}


def test_two_people_do_not_overwrite_each_other(document: Document) -> None:
    put(document, side="left", mode="practice")
    put(document, seen=1, side="right")
    with pytest.raises(ConflictError, match=r"side: changed by Ada in revision 2"):
        put(document, seen=1, side="left")
    put(document, seen=1, mode="match")  # another entry: no conflict
    with pytest.raises(ConflictError):
        document.undo(who="Bob", seen=2)  # he has not seen revision 3


def test_a_change_that_fails_leaves_nothing(document: Document) -> None:
    with pytest.raises(TypeError):
        document.change({"a": 1, "b": object()}, who="Ada", what="no JSON")
    assert (document.entries(), document.revision) == ({}, 0)


STEPS = st.lists(
    st.one_of(
        st.tuples(st.just("set"), st.sampled_from("abc"), st.one_of(st.none(), st.integers(0, 3))),
        st.tuples(st.just("undo"), st.none(), st.none()),
        st.tuples(st.just("redo"), st.none(), st.none()),
    ),
    max_size=30,
)


@settings(max_examples=40, deadline=None)
@given(STEPS)
def test_undo_and_redo_are_those_of_a_stack_of_states(
    tmp_path_factory: pytest.TempPathFactory, steps: list[tuple[str, str | None, int | None]]
) -> None:
    document = Document(tmp_path_factory.mktemp("document") / "venue.db")
    states: list[dict[str, Any]] = [{}]
    at = 0
    for kind, key, value in steps:
        if kind == "set":
            assert key is not None
            after = {k: v for k, v in {**states[at], key: value}.items() if v is not None}
            if document.change({key: value}, who="Ada", what="set") is not None:
                states = [*states[: at + 1], after]
                at += 1
        elif kind == "undo" and at > 0:
            document.undo(who="Ada", seen=document.revision)
            at -= 1
        elif kind == "redo" and at < len(states) - 1:
            document.redo(who="Ada", seen=document.revision)
            at += 1
        assert document.entries() == states[at]
    document.close()
