"""The dialogue of ``pslv venue new``: takes each answer from an option, or asks for it on a terminal."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

import msgspec
import typer

from app.commands.progress import Progress
from vision_core.calibration.result import Progress as Tell
from vision_core.errors import PslvError, SettingsError
from vision_core.geometry import Bytes
from vision_core.native.opencv import read_picture
from vision_core.objects.robots.scene import counted
from vision_core.palette.result import paint_in_words
from vision_core.settings.schema import HexColor
from vision_core.setup.camera import find_camera
from vision_core.setup.choices import missing_colors, pattern_choices, with_pattern, with_preset, with_sample
from vision_core.setup.colors import find_all_colors, sample_at
from vision_core.setup.draft import Draft, DraftPicture
from vision_core.setup.findings import CameraTrial, taken, with_colors
from vision_core.setup.jobs import CameraWish, Corners
from vision_core.setup.recognize import recognize_field
from vision_core.setup.run import look_at
from vision_core.venues.presets import shipped, shipped_fields

T = TypeVar("T")
FIND = "find"
FIND_COLORS = "find the colors in the pictures by themselves?"
RADIUS_PX = 2
"""A sample is the median of the square so far round its place."""


@dataclass(frozen=True, slots=True)
class Answers:
    """What the options say; None and (): not said."""

    name: str
    about: str
    source: str
    pictures: tuple[Path, ...]
    field: str | None
    size: str | None
    pattern: str | None
    marker_height: float | None
    robot_radius: float | None
    numbers: int | None
    ball: str | None
    ball_radius: float | None
    corners: str | None
    walls: bool
    height: float | None
    swap_ends: bool
    measures: bool
    samples: tuple[str, ...]
    finds_colors: bool


class Talk:
    """Asks, and shows how far a work is."""

    def __init__(self, *, interactive: bool, progress: Progress) -> None:
        """interactive: somebody can answer; otherwise a question is an error that names its option."""
        self.is_interactive = interactive
        self._progress = progress

    def ask(self, question: str, option: str, read: Callable[[str], T], default: str | None = None) -> T:
        """The answer to a question, asked again until it can be read. Raises SettingsError where nobody can answer."""
        if not self.is_interactive:
            raise SettingsError(option, found="not said, and no terminal to ask on", accepted=question)
        while True:
            try:
                return read(str(typer.prompt(question, default=default)).strip())
            except PslvError as error:
                typer.echo(f"  {error}")

    def agrees(self, question: str) -> bool:
        """Yes or no; yes where nobody can answer."""
        return not self.is_interactive or typer.confirm(question, default=True)

    def working(self, work: Callable[[Tell], T]) -> T:
        """The result of a work, which tells how far it is."""
        try:
            return work(lambda what, share: self._progress.show(f"{share:.0%} {what}"))
        finally:
            self._progress.show("")


def set_up(answers: Answers, talk: Talk) -> tuple[Draft, tuple[Path, ...]]:
    """A complete draft, and the files of its pictures. Raises PslvError for what cannot be used."""
    draft = _named(answers)
    files, pictures = _pictures(answers, talk)
    draft = msgspec.structs.replace(draft, pictures=pictures)
    pixels = [read_picture(file) for file in files]
    draft = _robots(_markers(draft, answers, talk), answers)
    draft = _field_and_camera(draft, pixels, answers, talk)
    return _colors(draft, pixels, answers, talk), files


def _named(answers: Answers) -> Draft:
    try:
        plain = {"name": answers.name, "about": answers.about, "source": answers.source}
        return msgspec.convert(plain, Draft)
    except msgspec.ValidationError as error:
        raise SettingsError(f"venue {answers.name}", found=str(error), accepted="a name as my-lab") from None


def _pictures(answers: Answers, talk: Talk) -> tuple[tuple[Path, ...], tuple[DraftPicture, ...]]:
    """Files that can be used, and what they are. A bad one of several is named and left out."""

    def read(text: str) -> tuple[Path, ...]:
        return (_existing(Path(text).expanduser()),)

    files = answers.pictures or talk.ask("a picture of the field, by the camera that will be used", "--pictures", read)
    found: list[tuple[Path, DraftPicture]] = []
    for file in files:
        size = (found[0][1].width_px, found[0][1].height_px) if found else None
        try:
            looked = look_at(file, file.name, size, needs_color=True)
        except PslvError as error:
            if len(files) == 1:
                raise
            typer.echo(f"left out: {error}", err=True)
            continue
        found.append(
            (file, DraftPicture(file=file.name, name=file.name, width_px=looked.width_px, height_px=looked.height_px))
        )
    if not found:
        raise SettingsError("--pictures", found="no picture that can be used", accepted="a picture of the field")
    return tuple(file for file, _ in found), tuple(picture for _, picture in found)


def _existing(path: Path) -> Path:
    if not path.is_file():
        raise SettingsError(f"picture {path}", found="no such file", accepted="a picture's path")
    return path


def _markers(draft: Draft, answers: Answers, talk: Talk) -> Draft:
    if answers.pattern is not None:
        return with_pattern(draft, answers.pattern)
    names = list(pattern_choices())
    return talk.ask(f"the robots' markers: {', '.join(names)}", "--pattern", lambda text: with_pattern(draft, text))


def _robots(draft: Draft, answers: Answers) -> Draft:
    """With the sizes that options say."""
    said = {
        "robot_height_m": answers.marker_height,
        "robot_radius_m": answers.robot_radius,
        "numbers": answers.numbers,
        "ball_color": answers.ball,
        "ball_radius_m": answers.ball_radius,
    }
    return msgspec.structs.replace(draft, **{key: value for key, value in said.items() if value is not None})


def _field_and_camera(draft: Draft, pixels: Sequence[Bytes], answers: Answers, talk: Talk) -> Draft:
    """With the field that is named or recognized, and its camera."""
    names = ", ".join(shipped("fields"))
    field = answers.field or talk.ask(
        f"the field: {names}; or {FIND}: search its lines", "--field", _one_of_fields, default=FIND
    )
    if field != FIND:
        draft = _sized(with_preset(draft, field), answers)
        return _camera(draft, pixels, answers, talk)
    trials = talk.working(
        lambda tell: recognize_field(
            pixels, shipped_fields(), marker_height_m=draft.robot_height_m, height_m=answers.height, progress=tell
        )
    )
    for trial in trials:
        verdict = "its lines are there" if trial.camera.camera is not None else str(trial.camera.reasons[0])
        typer.echo(f"{trial.preset}: {trial.painted:.0%} of its lines are seen; {verdict}")
    best = trials[0]
    if best.camera.camera is not None and answers.corners is None and talk.agrees(f"take {best.preset}?"):
        return taken(with_preset(draft, best.preset), best.camera)
    accepted = f"one of {names}, with --corners"
    preset = talk.ask(f"the field, {accepted}", "--field find", _one_of_fields, default=best.preset)
    return _camera(_sized(with_preset(draft, preset), answers), pixels, answers, talk)


def _one_of_fields(text: str) -> str:
    if text == FIND or text.endswith(".toml") or text in shipped("fields"):
        return text
    raise SettingsError(f"field {text}", found="no such preset", accepted=", ".join((*shipped("fields"), FIND)))


def _sized(draft: Draft, answers: Answers) -> Draft:
    """With the field's length and width that an option says."""
    if answers.size is None or draft.field is None:
        return draft
    length, width = _numbers(answers.size, 2, "--size", "LENGTH,WIDTH in metres")
    try:
        field = msgspec.structs.replace(draft.field, name=draft.name, length_m=length, width_m=width)
        field = msgspec.convert(msgspec.to_builtins(field), type(draft.field))
    except msgspec.ValidationError as error:
        raise SettingsError(f"--size {answers.size}", found=str(error), accepted="0.2 to 30 m") from None
    return msgspec.structs.replace(draft, field=field)


def _camera(draft: Draft, pixels: Sequence[Bytes], answers: Answers, talk: Talk) -> Draft:
    """With a camera that is not refused; on a terminal other corners may be tried."""
    wish = _wish(answers.corners or FIND, answers)
    while True:
        trial = talk.working(lambda tell, wish=wish: find_camera(draft, pixels, wish, tell))  # type: ignore[misc]
        _tell(trial)
        if trial.camera is not None and talk.agrees("take this camera?"):
            return taken(draft, trial)
        if not talk.is_interactive:
            return taken(draft, trial)  # says why not
        question = "pixels X,Y of the field's corners left top, right top, right bottom, left bottom; after them walls"
        wish = talk.ask(f"{question}, if no lines are painted", "--corners", lambda text: _wish(text, answers))


def _wish(text: str, answers: Answers) -> CameraWish:
    """How the camera is to be searched, by what --corners says. Raises SettingsError."""
    words = text.split()
    walls = answers.walls or words[-1:] == ["walls"]
    places = "".join(word if word.endswith(",") else f"{word}," for word in words if word != "walls").rstrip(",")
    corners: Corners | None = None
    if places != FIND:
        x = _numbers(places, 8, "--corners", "eight numbers: X,Y of four corners")
        corners = (x[0], x[1]), (x[2], x[3]), (x[4], x[5]), (x[6], x[7])
    return CameraWish(
        begin="walls" if walls else "corners" if corners is not None else "find",
        corners_px=corners,
        height_m=answers.height,
        swaps_ends=answers.swap_ends,
        frees_measures=answers.measures,
    )


def _tell(trial: CameraTrial) -> None:
    found = trial.calibration
    if found is not None:
        typer.echo(f"camera: {found.rms_px:.2f} px rms over {found.samples} sections, {trial.height_m:.2f} m high")
    else:
        typer.echo(f"camera: from four corners, {trial.height_m:.2f} m high")
    for note in trial.notes:
        typer.echo(f"  note: {note}")
    for reason in trial.reasons:
        typer.echo(f"  refused: {reason}")


def _colors(draft: Draft, pixels: Sequence[Bytes], answers: Answers, talk: Talk) -> Draft:
    """With samples of every color."""
    finds = answers.finds_colors or (talk.is_interactive and not answers.samples and talk.agrees(FIND_COLORS))
    draft = _found(draft, pixels, answers, talk) if finds else draft
    for text in answers.samples:
        draft = _sampled(draft, pixels, text)
    while missing := missing_colors(draft):
        name, now = missing[0], draft
        question = f"{name}: X,Y of it in the first picture, N:X,Y in the N-th, or #rrggbb"
        draft = talk.ask(question, f"--sample {name}=X,Y", lambda text: _sampled(now, pixels, f"{name}={text}"))  # noqa: B023
    return draft


def _found(draft: Draft, pixels: Sequence[Bytes], answers: Answers, talk: Talk) -> Draft:
    """With colors that are found in the pictures; on a terminal doubtful ones are named instead of taken."""
    trial = talk.working(lambda tell: find_all_colors(draft, pixels, tell))
    for paint in trial.paints:
        typer.echo(f"{paint.name}: {paint.color}, {paint_in_words(paint.patches)}")
    robots, balls = counted(trial.robots, "robot"), counted(trial.balls, "ball")
    typer.echo(f"with these colors: {robots}, {trial.with_id} with an id, {balls}")
    for reason in trial.reasons:
        typer.echo(f"  {reason}")
    if trial.is_accepted:
        return with_colors(draft, trial) if answers.finds_colors or talk.agrees("take these colors?") else draft
    return draft if talk.is_interactive or answers.samples else with_colors(draft, trial)  # says why not


def _sampled(draft: Draft, pixels: Sequence[Bytes], text: str) -> Draft:
    """With one more sample: "orange=314,262". Raises SettingsError."""
    name, _, place = text.partition("=")
    asked, accepted = f"--sample {text}", "CLASS=X,Y, CLASS=N:X,Y or CLASS=#rrggbb"
    if place.startswith("#"):
        try:
            return with_sample(draft, name, msgspec.convert(place.lower(), HexColor))
        except msgspec.ValidationError:
            raise SettingsError(asked, found="no color", accepted=accepted) from None
    number, _, pair = place.rpartition(":")
    if number and not (number.isdecimal() and 1 <= int(number) <= len(pixels)):
        raise SettingsError(asked, found=f"picture {number}", accepted=f"picture 1 to {len(pixels)}")
    x, y = _numbers(pair, 2, asked, accepted)
    found = sample_at(draft, pixels[int(number or 1) - 1], (int(x), int(y)), RADIUS_PX)
    return with_sample(draft, name, found.color)


def _numbers(text: str, count: int, asked: str, accepted: str) -> list[float]:
    try:
        numbers = [float(part) for part in text.split(",")]
    except ValueError:
        numbers = []
    if len(numbers) != count:
        raise SettingsError(f"{asked} {text}".strip(), found=f"not {count} numbers", accepted=accepted)
    return numbers
