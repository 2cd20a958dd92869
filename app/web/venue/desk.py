"""The draft of a new venue, one per service, and the steps that look at its pictures, each in a process of its own."""

import threading
from http import HTTPStatus
from pathlib import Path
from typing import TypeVar

import msgspec

from app.web.background import BackgroundJob
from app.web.problems import RequestRefused
from app.web.venue.asking import asked, refused
from vision_core.errors import PslvError
from vision_core.geometry import Bytes
from vision_core.native.opencv import encode_png
from vision_core.settings.schema import Settings
from vision_core.setup.choices import with_preset, with_sample
from vision_core.setup.draft import Draft, DraftPicture
from vision_core.setup.findings import (
    CameraTrial,
    ClassMap,
    ColorTrial,
    FieldTrial,
    Looked,
    Picked,
    Sampled,
    VenueTrial,
    taken,
    with_colors,
)
from vision_core.setup.folder import DraftFolder
from vision_core.setup.jobs import (
    CameraWish,
    FindCamera,
    FindColors,
    Look,
    MapClasses,
    Pick,
    Recognize,
    SetupJob,
    Show,
    Try,
)
from vision_core.startup import SET_UP
from vision_core.types.job_step import JobStep

T = TypeVar("T")
Fields = tuple[FieldTrial, ...]
THUMBNAIL_PX = 240
BROWSER_PX = 8192
SHOWN = 64
"""Pictures that are kept as a browser shows them."""


class Desk:
    """Draft, findings and jobs. Threads may share it."""

    def __init__(self, folder: Path) -> None:
        self.drafts = DraftFolder(folder)
        self.job = BackgroundJob("a step of the new venue")
        self.step = ""
        """The step of the newest job: field, camera, colors or trial."""
        self._upload = threading.Lock()
        self._shown: dict[tuple[str, int], bytes] = {}
        self._classes: tuple[tuple[int, str], ClassMap] | None = None
        """The newest class map, with the draft's number and the picture that it is of."""

    @property
    def draft(self) -> Draft:
        """The draft that holds."""
        return self.drafts.draft

    def add_picture(self, name: str, data: bytes) -> None:
        """Take a picture's file into the draft. Raises RequestRefused, naming it; the draft stays as it is then."""
        with self._upload, refused(HTTPStatus.UNPROCESSABLE_ENTITY, field="picture"):
            self.drafts.room_for(name, len(data))
            path = self.drafts.unlisted(name, data)
            try:
                looked = asked(Look(str(path), name, self.draft.size_px, needs_color=True), Looked, f"picture {name}")
                self.drafts.add(path, name, (looked.width_px, looked.height_px))
            except (PslvError, RequestRefused):
                self.drafts.drop(path)
                raise

    def add_pixels(self, name: str, pixels: Bytes) -> None:
        """Take a picture of the camera into the draft; shape (height, width, 3). Raises RequestRefused."""
        self.add_picture(name, encode_png(pixels))

    def change(self, draft: Draft, what: str, seen: int | None = None) -> None:
        """Let another draft hold. Raises RequestRefused for one that cannot be, and when somebody else was faster."""
        try:
            draft = msgspec.json.decode(msgspec.json.encode(draft), type=Draft)  # checks every limit
        except msgspec.ValidationError as error:
            raise RequestRefused(
                HTTPStatus.UNPROCESSABLE_ENTITY, what, found=str(error), accepted="values within their limits"
            ) from None
        with refused(HTTPStatus.CONFLICT):
            self.drafts.change(draft, what, seen)

    def undo(self) -> None:
        """Take the newest change back. Raises RequestRefused."""
        with refused(HTTPStatus.CONFLICT):
            self.drafts.undo()

    def redo(self) -> None:
        """Make the change again that was taken back last. Raises RequestRefused."""
        with refused(HTTPStatus.CONFLICT):
            self.drafts.redo()

    def recognize(self, height_m: float | None) -> None:
        """Begin to try every field preset. Raises RequestRefused."""
        self._begin("field", Recognize(self._pictures(), self.draft.robot_height_m, height_m))

    def calibrate(self, wish: CameraWish) -> None:
        """Begin to search the camera. Raises RequestRefused."""
        if self.draft.field is None:
            accepted = "a field preset first: recognized or chosen"
            raise RequestRefused(HTTPStatus.CONFLICT, "the camera", found="no field yet", accepted=accepted)
        self._begin("camera", FindCamera(self.draft, self._pictures(), wish))

    def find_colors(self) -> None:
        """Begin to search the colors of markers and ball. Raises RequestRefused."""
        self._begin("colors", FindColors(self.draft, self._pictures()))

    def take_colors(self, *, takes_doubtful: bool) -> None:
        """Let the colors that were found be the draft's.

        Raises RequestRefused for those of other markers, and for doubtful ones unless they are wanted all the same.
        """
        found = self.colors()
        if found is None or not self.is_worn(found[0]):
            words = "none yet" if found is None else "those of other pictures or markers"
            raise RequestRefused(HTTPStatus.CONFLICT, "the colors", found=words, accepted="a search first")
        with refused(HTTPStatus.CONFLICT):
            self.drafts.change(
                with_colors(self.draft, found[1], takes_doubtful=takes_doubtful), "colors that were found"
            )

    def try_it(self, in_use: Settings) -> None:
        """Begin to look at the pictures with the draft and with the settings in use. Raises RequestRefused."""
        self._begin("trial", Try(self.draft, self._pictures(), in_use, str(self.drafts.overlays)))

    def fields(self) -> tuple[int, Fields] | None:
        """The newest trial of the presets, and the number of the draft that it is of."""
        return self.drafts.finding("field", Fields)

    def camera(self) -> tuple[int, CameraTrial] | None:
        """The newest camera that was searched, and the number of the draft that it is of."""
        return self.drafts.finding("camera", CameraTrial)

    def colors(self) -> tuple[int, ColorTrial] | None:
        """The newest colors that were found, and the number of the draft that they are of."""
        return self.drafts.finding("colors", ColorTrial)

    def trial(self) -> tuple[int, VenueTrial] | None:
        """What was seen with the venue, and the number of the draft that it is of."""
        return self.drafts.finding("trial", VenueTrial)

    def take_field(self, preset: str) -> None:
        """Choose a preset, with its camera where the search has found one. Raises RequestRefused."""
        fields = self.fields()
        with refused(HTTPStatus.UNPROCESSABLE_ENTITY, field="preset"):
            draft, found = with_preset(self.draft, preset), None
            if fields is not None and self.is_of_these_pictures(fields[0]):
                found = next((one.camera for one in fields[1] if one.preset == preset), None)
                draft = taken(draft, found) if found is not None and found.camera is not None else draft
            self.drafts.change(draft, f"field {preset}")
            if found is not None:
                self.drafts.keep_finding("camera", self.drafts.number, msgspec.msgpack.encode(found))

    def take_camera(self) -> None:
        """Let the newest camera be the draft's. Raises RequestRefused when it is refused, or of another field."""
        found = self.camera()
        if found is None or not self.is_current(found[0]):
            words = "none yet" if found is None else "one for other pictures or another field"
            raise RequestRefused(HTTPStatus.CONFLICT, "the camera", found=words, accepted="a search first")
        with refused(HTTPStatus.CONFLICT):
            self.drafts.change(taken(self.draft, found[1]), "camera")

    def is_current(self, number: int) -> bool:
        """Is a camera that was searched with a draft one for the present pictures and field?"""
        draft = self.drafts.draft_of(number)
        return draft is not None and draft.field == self.draft.field and self.is_of_these_pictures(number)

    def is_worn(self, number: int) -> bool:
        """Are colors that were found with a draft those of the present pictures, markers and ball?"""
        draft, now = self.drafts.draft_of(number), self.draft
        worn = draft is not None and (draft.pattern, draft.ball_color) == (now.pattern, now.ball_color)
        return worn and self.is_of_these_pictures(number)

    def is_tried(self, number: int) -> bool:
        """Does a draft that was tried see what the present one sees? Names change nothing of that."""
        draft = self.drafts.draft_of(number)
        return draft is not None and _seen_with(draft) == _seen_with(self.draft)

    def is_of_these_pictures(self, number: int) -> bool:
        """Was a draft made of pictures that the present one still has?"""
        draft = self.drafts.draft_of(number)
        return draft is not None and set(draft.pictures) <= set(self.draft.pictures)

    def sample(self, index: int, place_px: tuple[int, int], radius_px: int, name: str) -> Sampled:
        """Add the color of a place to a class. index: of the picture. Raises RequestRefused."""
        picture = self._picture(index)
        job = Pick(self.draft, picture, place_px, radius_px, name)
        picked = asked(job, Picked, f"a sample of {name}")
        color = picked.sampled.color
        with refused(HTTPStatus.UNPROCESSABLE_ENTITY, field="name"):
            self.drafts.change(with_sample(self.draft, name, color), f"sample {color} of {name}")
        if self.draft == with_sample(job.draft, name, color):
            self._classes = (self.drafts.number, picture), picked.classes
        return picked.sampled

    def classes(self, index: int) -> ClassMap:
        """The class of every pixel of a picture. Raises RequestRefused."""
        of = self.drafts.number, self._picture(index)
        if self._classes is None or self._classes[0] != of:
            self._classes = of, asked(MapClasses(self.draft, of[1]), ClassMap, "the color classes")
        return self._classes[1]

    def shown(self, index: int, *, small: bool) -> bytes:
        """A picture as a JPEG. Raises RequestRefused."""
        path, width = self._picture(index), THUMBNAIL_PX if small else BROWSER_PX
        if (path, width) not in self._shown:
            while len(self._shown) >= SHOWN:
                self._shown.pop(next(iter(self._shown)), None)
            self._shown[path, width] = asked(Show(path, width), bytes, "the picture")
        return self._shown[path, width]

    def picture(self, index: int) -> DraftPicture:
        """A picture of the draft. Raises RequestRefused."""
        pictures = self.draft.pictures
        if not 0 <= index < len(pictures):
            accepted = f"0 to {len(pictures) - 1}" if pictures else "a picture first"
            raise RequestRefused(HTTPStatus.NOT_FOUND, f"picture {index}", found="no such picture", accepted=accepted)
        return pictures[index]

    def overlay(self, index: int) -> bytes:
        """What was seen in a picture, drawn over it: PNG. Raises RequestRefused."""
        path = self.drafts.overlays / f"{Path(self._picture(index)).stem}.png"
        try:
            return path.read_bytes()
        except OSError:
            raise RequestRefused(
                HTTPStatus.NOT_FOUND, "the overlay", found="none", accepted="the venue tried first"
            ) from None

    def _pictures(self) -> tuple[str, ...]:
        if not self.draft.pictures:
            raise RequestRefused(HTTPStatus.CONFLICT, "this step", found="no picture", accepted="a picture first")
        return tuple(map(str, self.drafts.pictures))

    def _picture(self, index: int) -> str:
        return str(self.drafts.path_of(self.picture(index)))

    def _begin(self, step: str, job: SetupJob) -> None:
        of = self.drafts.number

        def keep(last: JobStep) -> None:
            assert last.result is not None
            self.drafts.keep_finding(step, of, last.result)

        self.job.start(SET_UP, msgspec.msgpack.encode(job), keep)
        self.step = step


def _seen_with(draft: Draft) -> Draft:
    """What of a draft decides what is seen."""
    return msgspec.structs.replace(draft, name=Draft().name, about="", source="")
