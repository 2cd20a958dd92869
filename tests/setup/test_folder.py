"""A draft survives on the disk, with its pictures and its history; what cannot be read is set aside."""

from pathlib import Path

import msgspec
import pytest

from vision_core.errors import SettingsError
from vision_core.setup import folder as folders
from vision_core.setup.draft import Draft
from vision_core.setup.folder import UNDO_DEPTH, DraftFolder


def renamed(drafts: DraftFolder, name: str) -> None:
    drafts.change(msgspec.structs.replace(drafts.draft, name=name), f"name {name}")


def with_picture(drafts: DraftFolder, name: str = "a.png") -> Path:
    path = drafts.unlisted(name, b"pixels")
    drafts.add(path, name, (640, 480))
    return path


def test_a_draft_is_there_again_with_its_history(tmp_path: Path) -> None:
    drafts = DraftFolder(tmp_path / "draft")
    assert (drafts.draft, drafts.undoable, drafts.redoable) == (Draft(), None, None)
    with_picture(drafts)
    renamed(drafts, "lab")
    drafts.keep_finding("camera", drafts.number, msgspec.msgpack.encode({"height": 2.0}))
    again = DraftFolder(tmp_path / "draft")
    assert again.draft == drafts.draft
    assert again.number == drafts.number
    assert again.pictures[0].read_bytes() == b"pixels"
    assert again.finding("camera", dict[str, float]) == (drafts.number, {"height": 2.0})
    assert again.undoable == "name lab"
    again.undo()
    assert again.draft.name == "my-venue"
    assert again.redoable == "name lab"
    again.redo()
    assert again.draft.name == "lab"


def test_a_number_is_never_given_twice(tmp_path: Path) -> None:
    drafts = DraftFolder(tmp_path)
    renamed(drafts, "one")
    drafts.undo()
    renamed(drafts, "two")
    assert drafts.number == 2
    assert drafts.redoable is None
    with pytest.raises(SettingsError, match="nothing to redo"):
        drafts.redo()


def test_who_has_not_seen_the_newest_draft_changes_nothing(tmp_path: Path) -> None:
    drafts = DraftFolder(tmp_path)
    renamed(drafts, "one")
    with pytest.raises(SettingsError, match="a newer draft: name one"):
        drafts.change(Draft(name="two"), "name two", seen=0)
    assert drafts.draft.name == "one"


def test_a_picture_stays_as_long_as_it_can_be_undone(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(folders, "UNDO_DEPTH", 3)
    drafts = DraftFolder(tmp_path)
    path = with_picture(drafts)
    drafts.change(msgspec.structs.replace(drafts.draft, pictures=()), "without a.png")
    assert path.exists()
    for number in range(3):
        renamed(drafts, f"lab{number}")
    assert not path.exists()
    assert UNDO_DEPTH > 10


def test_a_picture_that_is_looked_at_is_not_taken_away(tmp_path: Path) -> None:
    drafts = DraftFolder(tmp_path)
    path = drafts.unlisted("b.png", b"pixels")
    renamed(drafts, "lab")
    assert path.exists()
    drafts.drop(path)
    assert not path.exists()


@pytest.mark.parametrize("name", ["../../etc/passwd", "C:\\pictures\\a.png", "a\n\x00.png", "...", ""])
def test_a_name_leads_nowhere(tmp_path: Path, name: str) -> None:
    drafts = DraftFolder(tmp_path)
    path = with_picture(drafts, name)
    assert path.parent == tmp_path / "pictures"
    shown = drafts.draft.pictures[0].name
    assert shown
    assert not {"/", "\\", "\n", "\0"} & set(shown)


def test_too_much_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    drafts = DraftFolder(tmp_path)
    with pytest.raises(SettingsError, match=r"picture a\.png; found: 40 MB; accepted: at most 34 MB"):
        drafts.room_for("a.png", 40_000_000)
    monkeypatch.setattr(folders, "MAX_PICTURES", 1)
    with_picture(drafts)
    with pytest.raises(SettingsError, match="1 pictures already"):
        drafts.room_for("b.png", 1)
    monkeypatch.setattr(folders, "MAX_PICTURES", 9)
    monkeypatch.setattr(folders, "MAX_ALL_BYTES", 10)
    with pytest.raises(SettingsError, match="no room for one more"):
        drafts.room_for("b.png", 5)


@pytest.mark.parametrize("text", ["{", '{"steps": [], "at": 0}', '{"steps": 7}', '{"at": 9}'])
def test_a_damaged_draft_is_set_aside(tmp_path: Path, text: str) -> None:
    (tmp_path / "draft.json").write_text(text)
    drafts = DraftFolder(tmp_path)
    assert drafts.draft == Draft()
    assert "starts anew" in drafts.notice
    assert (tmp_path / "draft.damaged").read_text() == text
    (tmp_path / "camera.found").write_bytes(b"\xff")
    assert drafts.finding("camera", int) is None
