"""Pictures that the camera is calibrated by, and those of a board: taken by the camera in use, or given as files."""

import shutil
import threading
from dataclasses import dataclass
from enum import StrEnum
from http import HTTPStatus
from pathlib import Path

from app.web.problems import RequestRefused
from app.web.venue.asking import asked
from vision_core.calibration.job import PictureFile
from vision_core.geometry import Bytes
from vision_core.native.opencv import encode_png
from vision_core.setup.findings import Looked
from vision_core.setup.folder import MAX_FILE_BYTES, SUFFIXES
from vision_core.setup.jobs import Look, Show

MAX_PICTURES = 16
THUMBNAIL_PX, BROWSER_PX = 240, 8192
NAME_LENGTH = 60


class Shown(StrEnum):
    """What pictures show."""

    FIELD = "field"
    BOARD = "board"
    ONBOARD = "onboard"
    """What a robot's own camera sees through its mirror."""


@dataclass(frozen=True, slots=True)
class CalibrationPicture:
    """A picture in a file."""

    number: int
    """No other picture has ever had it."""
    kind: Shown
    name: str
    path: Path
    size_px: tuple[int, int]
    """Width and height."""


class CalibrationPictures:
    """All of them, in a folder that is emptied at the start. Threads may share it."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._lock = threading.RLock()
        self._pictures: dict[int, CalibrationPicture] = {}
        self._shown: dict[tuple[int, int], bytes] = {}
        self._ceilings: dict[int, float] = {}
        self._made = 0
        shutil.rmtree(folder, ignore_errors=True)

    def of(self, kind: Shown) -> list[CalibrationPicture]:
        """The pictures of a kind, in the order in which they were given."""
        return [one for one in self._pictures.values() if one.kind is kind]

    def files(self, kind: Shown) -> tuple[PictureFile, ...]:
        """The same for a job. Raises RequestRefused when there is none."""
        found = tuple(PictureFile(str(one.path), one.name) for one in self.of(kind))
        if not found:
            what = {Shown.FIELD: "a calibration", Shown.BOARD: "a lens", Shown.ONBOARD: "pairs of a mirror"}[kind]
            raise RequestRefused(HTTPStatus.CONFLICT, what, found="no picture", accepted="take a picture first")
        return found

    def add_pixels(self, kind: Shown, name: str, pixels: Bytes) -> None:
        """Take a picture of the camera; shape (height, width, 3). Raises RequestRefused."""
        self.add(kind, name, encode_png(pixels))

    def add(self, kind: Shown, name: str, data: bytes) -> int:
        """Take a picture's file; its number. Raises RequestRefused, naming it; all others stay."""
        called = f"picture {name[:NAME_LENGTH]}"
        if len(data) > MAX_FILE_BYTES:
            accepted = f"at most {MAX_FILE_BYTES / 1e6:.0f} MB"
            raise _refusal(called, f"{len(data) / 1e6:.0f} MB", accepted)
        with self._lock:
            others = self.of(kind)
            if len(others) >= MAX_PICTURES:
                raise _refusal(called, f"{MAX_PICTURES} pictures already", "take some out first")
            self._made += 1
            suffix = Path(name).suffix.lower()
            path = self._folder / f"{self._made}{suffix if suffix in SUFFIXES else '.png'}"
            try:
                self._folder.mkdir(parents=True, exist_ok=True, mode=0o700)
                path.write_bytes(data)
            except OSError as error:
                raise _refusal(called, error.strerror or str(error), "a data folder that can be written") from None
            try:
                size = others[0].size_px if others else None
                looked = asked(Look(str(path), name[:NAME_LENGTH], size, needs_color=False), Looked, called)
            except RequestRefused:
                path.unlink(missing_ok=True)
                raise
            size = looked.width_px, looked.height_px
            self._pictures[self._made] = CalibrationPicture(self._made, kind, name[:NAME_LENGTH], path, size)
            return self._made

    def keep_ceiling(self, number: int, pixels: Bytes, taken_s: float) -> None:
        """Keep the ceiling camera's picture of the same instant beside a picture; shape (height, width, 3).

        taken_s: when it was taken [seconds since 1970]. Raises RequestRefused without a picture of this number.
        """
        with self._lock:
            self._ceiling(number).write_bytes(encode_png(pixels))
            self._ceilings[number] = taken_s

    def ceiling_s(self, number: int) -> float | None:
        """When the ceiling camera's picture beside one was taken [seconds since 1970]; None: there is none."""
        return self._ceilings.get(number)

    def ceiling(self, number: int) -> Path:
        """The ceiling camera's picture beside one. Raises RequestRefused without one."""
        if number not in self._ceilings:
            raise RequestRefused(
                HTTPStatus.CONFLICT,
                f"what stands around the robot of {self.picture(number).name}",
                found="no picture of the ceiling camera of its time",
                accepted="one that is taken while the robot stands where it stood, or distances as text",
            )
        return self._ceiling(number)

    def _ceiling(self, number: int) -> Path:
        return self._folder / f"{self.picture(number).number}-ceiling.png"

    def file(self, number: int, kind: Shown) -> PictureFile:
        """One of them for a job. Raises RequestRefused when there is none of this number and kind."""
        found = self.picture(number)
        if found.kind is not kind:
            accepted = ", ".join(str(one.number) for one in self.of(kind)) or "a picture first"
            raise RequestRefused(
                HTTPStatus.NOT_FOUND, f"picture {number}", found=f"one of a {found.kind}", accepted=accepted
            )
        return PictureFile(str(found.path), found.name)

    def remove(self, number: int) -> None:
        """Take a picture out. Raises RequestRefused."""
        with self._lock:
            self.picture(number).path.unlink(missing_ok=True)
            self._ceiling(number).unlink(missing_ok=True)
            self._ceilings.pop(number, None)
            del self._pictures[number]
            self._shown = {key: data for key, data in self._shown.items() if key[0] != number}

    def clear(self, kind: Shown) -> None:
        """Take all pictures of a kind out."""
        with self._lock:
            for one in self.of(kind):
                self.remove(one.number)

    def shown(self, number: int, *, small: bool) -> bytes:
        """A picture as a JPEG. Raises RequestRefused."""
        width = THUMBNAIL_PX if small else BROWSER_PX
        if (number, width) not in self._shown:
            path = self.picture(number).path
            self._shown[number, width] = asked(Show(str(path), width), bytes, "the picture")
        return self._shown[number, width]

    def picture(self, number: int) -> CalibrationPicture:
        """By its number. Raises RequestRefused."""
        found = self._pictures.get(number)
        if found is None:
            accepted = ", ".join(map(str, self._pictures)) or "a picture first"
            raise RequestRefused(HTTPStatus.NOT_FOUND, f"picture {number}", found="no such picture", accepted=accepted)
        return found


def _refusal(asked_for: str, found: str, accepted: str) -> RequestRefused:
    return RequestRefused(HTTPStatus.UNPROCESSABLE_ENTITY, asked_for, found=found, accepted=accepted, field="picture")
