"""Keeps a draft on the disk: with its pictures, what was changed and can be undone, and what the steps found.

``draft.json`` holds the draft and its history. A picture stays in ``pictures`` as long as a draft of the history has
it. A finding is a file of its own, with the number of the draft that it is of.
"""

import re
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any, TypeVar

import msgspec
from msgspec import Struct

from vision_core.errors import SettingsError
from vision_core.setup.draft import MAX_PICTURES, Draft, DraftPicture

T = TypeVar("T")
MAX_FILE_BYTES = 32 * 1024 * 1024
"""Of a picture's file."""
MAX_ALL_BYTES = 512 * 1024 * 1024
"""Of all pictures of the history."""
UNDO_DEPTH = 100
SUFFIXES = {".png", ".jpg", ".jpeg", ".bmp", ".tif", ".tiff", ".webp"}


class Step(Struct, frozen=True):
    """A draft of the history."""

    number: int
    what: str
    """The change that made it, in words."""
    draft: Draft


class History(Struct, frozen=True):
    """Drafts, the oldest first, and which one holds."""

    steps: tuple[Step, ...] = (Step(0, "", Draft()),)
    at: int = 0


class Finding(Struct, frozen=True):
    """What a step found."""

    of: int
    """Number of the draft."""
    content: msgspec.Raw


class DraftFolder:
    """A draft in a folder. Threads may share it; one process at a time."""

    def __init__(self, folder: Path) -> None:
        """A folder that need not be there. A damaged draft is set aside: it starts anew, and ``notice`` says so."""
        self.folder = folder
        self.notice = ""
        self._lock = threading.RLock()
        self._unlisted: set[str] = set()
        """Files of pictures that are being looked at."""
        self._history = self._loaded()
        self._made = max(step.number for step in self._history.steps)

    @property
    def draft(self) -> Draft:
        """The draft that holds."""
        return self._now.draft

    @property
    def number(self) -> int:
        """Which draft holds; each change makes a new number."""
        return self._now.number

    @property
    def undoable(self) -> str | None:
        """The change that ``undo`` takes back; None: there is none."""
        return self._now.what if self._history.at else None

    @property
    def redoable(self) -> str | None:
        """The change that ``redo`` makes again; None: there is none."""
        steps, at = self._history.steps, self._history.at
        return steps[at + 1].what if at + 1 < len(steps) else None

    def change(self, draft: Draft, what: str, seen: int | None = None) -> None:
        """Let another draft hold. seen: the number that its maker has seen; None: any.

        Raises SettingsError when somebody else was faster, and when it cannot be written.
        """
        with self._lock:
            if seen is not None and seen != self.number:
                found = f"a newer draft: {self._now.what}"
                raise SettingsError(what, found=found, accepted="the same change after a look at it")
            if draft == self.draft:
                return
            self._made += 1
            steps = (*self._history.steps[: self._history.at + 1], Step(self._made, what, draft))[-UNDO_DEPTH:]
            self._keep(History(steps, len(steps) - 1))

    def undo(self) -> None:
        """Take the newest change back. Raises SettingsError."""
        self._move(-1, "undo")

    def redo(self) -> None:
        """Make the change again that was taken back last. Raises SettingsError."""
        self._move(1, "redo")

    def room_for(self, name: str, size_bytes: int) -> None:
        """Raise SettingsError when a picture's file is too large, or there are too many."""
        asked = f"picture {name}"
        if size_bytes > MAX_FILE_BYTES:
            found, accepted = f"{size_bytes / 1e6:.0f} MB", f"at most {MAX_FILE_BYTES / 1e6:.0f} MB"
            raise SettingsError(asked, found=found, accepted=accepted)
        if len(self.draft.pictures) >= MAX_PICTURES:
            accepted = f"at most {MAX_PICTURES} pictures: take some out first"
            raise SettingsError(asked, found=f"{MAX_PICTURES} pictures already", accepted=accepted)
        if sum(path.stat().st_size for path in self._files()) + size_bytes > MAX_ALL_BYTES:
            accepted = f"at most {MAX_ALL_BYTES / 1e6:.0f} MB in all: begin anew, or take smaller pictures"
            raise SettingsError(asked, found="no room for one more", accepted=accepted)

    def unlisted(self, name: str, data: bytes) -> Path:
        """Write a picture's file, which no draft has yet. Raises SettingsError."""
        suffix = Path(name).suffix.lower()
        with self._lock:
            numbers = [int(path.stem) for path in self._files() if path.stem.isdecimal()]
            path = self._pictures / f"{max(numbers, default=0) + 1}{suffix if suffix in SUFFIXES else '.png'}"
            self._unlisted.add(path.name)
            self._write(path, data)
        return path

    def add(self, path: Path, name: str, size_px: tuple[int, int]) -> None:
        """Take a picture that ``unlisted`` has written into the draft. Raises SettingsError."""
        with self._lock:
            draft = self.with_picture(path, name, size_px)
            self.change(draft, f"picture {draft.pictures[-1].name}")
            self._unlisted.discard(path.name)

    def drop(self, path: Path) -> None:
        """Delete a picture's file that ``unlisted`` has written and that cannot be used."""
        self._unlisted.discard(path.name)
        path.unlink(missing_ok=True)

    def with_picture(self, path: Path, name: str, size_px: tuple[int, int]) -> Draft:
        """The draft with one more picture."""
        shown = re.sub(r"[\x00-\x1f\x7f]", "", Path(name.replace("\\", "/")).name)[:80] or "picture"
        picture = DraftPicture(file=path.name, name=shown, width_px=size_px[0], height_px=size_px[1])
        return msgspec.structs.replace(self.draft, pictures=(*self.draft.pictures, picture))

    def path_of(self, picture: DraftPicture) -> Path:
        """Where a picture's file is."""
        return self._pictures / picture.file

    @property
    def pictures(self) -> list[Path]:
        """The files of the draft's pictures, in its order."""
        return [self.path_of(picture) for picture in self.draft.pictures]

    def draft_of(self, number: int) -> Draft | None:
        """A draft of the history by its number; None: it is not there any more."""
        return next((step.draft for step in self._history.steps if step.number == number), None)

    @property
    def overlays(self) -> Path:
        """The folder of overlays."""
        return self.folder / "overlays"

    def keep_finding(self, kind: str, of: int, content: bytes) -> None:
        """Keep what a step found of a draft. content: msgpack. Raises SettingsError."""
        self._write(self.folder / f"{kind}.found", msgspec.msgpack.encode(Finding(of, msgspec.Raw(content))))

    def finding(self, kind: str, form: type[T]) -> tuple[int, T] | None:
        """What a step found last, and the number of the draft that it is of; None: nothing that can be read."""
        try:
            data = (self.folder / f"{kind}.found").read_bytes()
            finding = msgspec.msgpack.decode(data, type=Finding)
            return finding.of, msgspec.msgpack.decode(finding.content, type=form)
        except (OSError, msgspec.MsgspecError):
            return None

    @property
    def _now(self) -> Step:
        return self._history.steps[self._history.at]

    @property
    def _pictures(self) -> Path:
        return self.folder / "pictures"

    def _files(self) -> Iterator[Path]:
        return iter(sorted(self._pictures.glob("*"))) if self._pictures.is_dir() else iter(())

    def _move(self, by: int, verb: str) -> None:
        with self._lock:
            at = self._history.at + by
            if not 0 <= at < len(self._history.steps):
                raise SettingsError(verb, found=f"nothing to {verb}", accepted="a change first")
            self._keep(History(self._history.steps, at))

    def _keep(self, history: History) -> None:
        self._write(self.folder / "draft.json", msgspec.json.format(msgspec.json.encode(history), indent=1))
        self._history = history
        listed = self._unlisted | {picture.file for step in history.steps for picture in step.draft.pictures}
        for path in self._files():
            if path.name not in listed:
                path.unlink(missing_ok=True)

    def _write(self, path: Path, data: bytes) -> None:
        try:
            path.parent.mkdir(parents=True, exist_ok=True, mode=0o700)
            unfinished = path.with_name(f".{path.name}.new")
            unfinished.write_bytes(data)
            unfinished.replace(path)
        except OSError as error:
            found, accepted = error.strerror or str(error), f"a folder that can be written: {path.parent}"
            raise SettingsError("the draft of a venue", found=found, accepted=accepted) from None

    def _loaded(self) -> History:
        path = self.folder / "draft.json"
        try:
            history: Any = msgspec.json.decode(path.read_bytes(), type=History)
            if not 0 <= history.at < len(history.steps):
                raise msgspec.ValidationError("no draft holds")
        except FileNotFoundError:
            return History()
        except (OSError, msgspec.MsgspecError) as error:
            aside = path.with_suffix(".damaged")
            try:
                path.replace(aside)
            except OSError:
                aside = path
            self.notice = f"the draft could not be read ({error}) and is kept as {aside.name}: it starts anew"
            return History()
        assert isinstance(history, History)
        return history
