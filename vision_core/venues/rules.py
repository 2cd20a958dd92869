"""Rules that span several settings."""

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass

from vision_core.errors import SettingsError
from vision_core.models.camera_setup import CameraSetup
from vision_core.models.field import diagonal_m
from vision_core.models.from_settings import mirror_from
from vision_core.models.mirror import check_span
from vision_core.settings.schema import ColorRange, HomographySettings, Settings

SPACE_KEYS = {
    "hsv": {"hue_deg", "saturation", "value"},
    "ymp": {"luma", "module", "phase_deg"},
    "ec": {"luma", "hue_deg", "saturation"},
}
ANGLES = {"hue_deg", "phase_deg"}
MAX_CLASSES = 31
LETTERS_PER_TEAM = 16
TASK_NAME = re.compile(r"[a-z][a-z0-9_]{0,15}")


@dataclass(frozen=True, slots=True)
class Violation:
    """A rule that does not hold."""

    key: str
    found: str
    accepted: str


def check_settings(settings: Settings, file_of: Callable[[str], str]) -> None:
    """Raise SettingsError for the first rule that does not hold; file_of names the file that sets a key."""
    for rule in (_colors, _letters, _match, _camera, _mirror, _tasks):
        for violation in rule(settings):
            where = f"{file_of(violation.key)}: {violation.key}"
            raise SettingsError(where, found=violation.found, accepted=violation.accepted)


def _colors(settings: Settings) -> Iterator[Violation]:
    samples = settings.colors.samples
    classes = [*settings.colors.classes, *(name for name in samples if name != "none")]
    if both := sorted(settings.colors.classes.keys() & samples.keys()):
        yield Violation("colors.samples", ", ".join(both), "classes that colors.classes does not have")
    if len(classes) > MAX_CLASSES:
        yield Violation("colors.classes", f"{len(classes)} classes", f"at most {MAX_CLASSES}")
    for name, boxes in settings.colors.classes.items():
        for box in boxes:
            yield from _box(f"colors.classes.{name}", box, settings.colors.space)
    low, high = settings.colors.light.band
    if low >= high:
        yield Violation("colors.light.band", f"[{low:g}, {high:g}]", "two shares, the lower one first")
    wanted = [("ball.color", settings.ball.color), *(("ball.surrounding", name) for name in settings.ball.surrounding)]
    for key, name in wanted:
        if name not in classes:
            yield Violation(key, repr(name), f"a color class: {', '.join(classes)}")


def _box(key: str, box: ColorRange, space: str) -> Iterator[Violation]:
    given = {axis: getattr(box, axis) for axis in box.__struct_fields__ if getattr(box, axis) is not None}
    if foreign := sorted(given.keys() - SPACE_KEYS[space]):
        yield Violation(key, ", ".join(foreign), f"{', '.join(sorted(SPACE_KEYS[space]))} (colors.space is {space})")
    for axis, (low, high) in given.items():
        if axis not in ANGLES and low > high:
            yield Violation(f"{key}.{axis}", f"[{low:g}, {high:g}]", "the lower end first")


def _letters(settings: Settings) -> Iterator[Violation]:
    for name in ("first_blue", "first_yellow"):
        first = getattr(settings.protocol.letters, name)
        if ord(first) + LETTERS_PER_TEAM - 1 > ord("~"):
            yield Violation(f"protocol.letters.{name}", repr(first), "a letter with 15 more behind it: A, a, ...")


def _match(settings: Settings) -> Iterator[Violation]:
    numbers = settings.match.numbers
    for key in ("blue_ids", "yellow_ids"):
        ids = getattr(settings.match, key)
        if len(ids) < numbers or len(set(ids)) < len(ids):
            yield Violation(f"match.{key}", f"{list(ids)}", f"at least match.numbers ({numbers}) ids, each once")


def _camera(settings: Settings) -> Iterator[Violation]:
    key = f"camera.{settings.camera.model}"
    if settings.camera.model == "homography" and settings.camera.homography is None:
        yield Violation(key, "nothing", "four named points, as camera.model says homography")
        return
    if settings.camera.homography is not None:
        yield from _points(settings, settings.camera.homography)
    try:
        camera = CameraSetup.from_settings(settings).model
    except SettingsError as error:
        yield Violation(key, error.found, error.accepted)
        return
    height_m = camera.position_m[2]
    if not height_m > settings.robots.height_m:
        yield Violation(f"{key}.position_m", f"{height_m:g} m high", "a camera higher than the robots' markers")


def _points(settings: Settings, homography: HomographySettings) -> Iterator[Violation]:
    """A corner may lie a little outside of the picture; far away it is a slip of the finger."""
    width, height = settings.camera.width_px, settings.camera.height_px
    for point in homography.points:
        x, y = point.pixel_px
        if not (-width / 2 <= x <= 1.5 * width and -height / 2 <= y <= 1.5 * height):
            found = f"{point.name!r} at ({x:g}, {y:g}) px"
            yield Violation("camera.homography.points", found, f"points in or near the picture of {width}x{height}")


def _mirror(settings: Settings) -> Iterator[Violation]:
    try:
        check_span(mirror_from(settings), diagonal_m(settings.field))
    except SettingsError as error:
        yield Violation("mirror", error.found, error.accepted)


def _tasks(settings: Settings) -> Iterator[Violation]:
    for name, task in settings.tasks.items():
        if not TASK_NAME.fullmatch(name):
            yield Violation(f"tasks.{name}", repr(name), "small letters, digits and _ , 16 at most, a letter first")
        if task.process and not TASK_NAME.fullmatch(task.process):
            yield Violation(f"tasks.{name}.process", repr(task.process), "a name as of a task, or nothing")
