"""A draft as a venue's file, explained like the shipped ones, and the settings that this file gives.

There is no other way from a draft to settings: what is tried is what is saved.
"""

import json
import textwrap
import time
from collections.abc import Mapping, Sequence
from pathlib import Path

import msgspec

from vision_core.errors import SettingsError
from vision_core.settings.schema import FieldSettings, Settings
from vision_core.setup.choices import missing_colors
from vision_core.setup.draft import Draft, DraftCamera
from vision_core.venues.camera_edit import camera_tables
from vision_core.venues.loader import config_folder, layers_of_text, own_venues_folder, settings_from_layers
from vision_core.venues.palette_edit import sample_line
from vision_core.venues.presets import field_of

PICTURES = "pictures"
"""As a draft's source: the given pictures are played."""
COMMENT_AT, WIDTH = 35, 118


def venue_text(draft: Draft) -> str:
    """The file of a venue; what the draft does not know yet is left out."""
    parts = [_head(draft), _field(draft), _source(draft), _camera(draft.camera), _colors(draft)]
    parts += [_robots(draft), f"[ball]\ncolor = {json.dumps(draft.ball_color)}\nradius_m = {draft.ball_radius_m!r}"]
    parts.append(_line(f"[match]\nnumbers = {draft.numbers}", "robots per team"))
    return "\n\n".join(filter(None, parts)) + "\n"


def settings_of(draft: Draft, *, complete: bool = False) -> Settings:
    """The settings with this venue. complete: as a service needs them, every color sampled.

    Raises SettingsError for what no venue can be, and for what is missing.
    """
    check_ready(draft, complete=complete)
    path = own_venues_folder() / f"{draft.name}.toml"
    return settings_from_layers(layers_of_text(path, venue_text(draft)), complete_palette=complete)


def check_ready(draft: Draft, *, complete: bool = False) -> None:
    """Raise SettingsError that names the first step that was not done; complete: the colors count too."""
    steps = [
        ("the pictures", bool(draft.pictures), "a picture of the field"),
        ("the field", draft.field is not None, "a field preset, or its measures"),
        ("the camera", draft.camera is not None, "a camera that was calibrated and taken"),
        ("the markers", bool(draft.pattern), "a pattern of config/patterns"),
    ]
    for asked, is_done, accepted in steps:
        if not is_done:
            raise SettingsError(asked, found="not chosen yet", accepted=accepted)
    if complete and (missing := missing_colors(draft)):
        accepted = "one sample or more of each color that the markers and the ball have"
        raise SettingsError("the colors", found=f"no sample of {', '.join(missing)}", accepted=accepted)


def save_venue(draft: Draft, pictures: Sequence[Path], *, replaces: bool = False) -> Path:
    """Write a complete draft as a venue of the data folder. pictures: the draft's files, in its order.

    They are copied beside it where the venue plays them. Raises SettingsError for a draft that is not complete, the
    name of a shipped venue, that of another file unless it replaces that, and a folder that cannot be written.
    """
    settings_of(draft, complete=True)
    asked = f"venue {draft.name}"
    if (config_folder() / "venues" / f"{draft.name}.toml").exists():
        raise SettingsError(asked, found="a venue of this name that comes with PSLV", accepted="another name")
    path = own_venues_folder() / f"{draft.name}.toml"
    if path.exists() and not replaces:
        raise SettingsError(asked, found=f"{path} is there already", accepted="another name, or to replace it")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        if draft.source == PICTURES:
            _copy(pictures, path.with_suffix(""))
        unfinished = path.with_name(f".{path.name}.new")
        unfinished.write_text(venue_text(draft), encoding="utf-8")
        unfinished.replace(path)
    except OSError as error:
        found = error.strerror or str(error)
        raise SettingsError(asked, found=found, accepted=f"a folder that can be written: {path.parent}") from None
    return path


def _copy(pictures: Sequence[Path], folder: Path) -> None:
    """Let a folder have these files alone."""
    folder.mkdir(exist_ok=True)
    for old in folder.iterdir():
        if old.is_file():
            old.unlink()
    for number, picture in enumerate(pictures, start=1):
        (folder / f"{number:03d}{picture.suffix}").write_bytes(picture.read_bytes())


def _head(draft: Draft) -> str:
    made = time.strftime("%Y-%m-%d")
    shown = ", ".join(" ".join(picture.name.split()) for picture in draft.pictures[:6])
    more = f" and {len(draft.pictures) - 6} more" if len(draft.pictures) > 6 else ""
    size = f" of {draft.size_px[0]}x{draft.size_px[1]}" if draft.size_px else ""
    count = "one picture" if len(draft.pictures) == 1 else f"{len(draft.pictures)} pictures"
    about = f"{' '.join(draft.about.split()) or draft.name}. Set up on {made} from {count}{size}: {shown}{more}."
    return _comment(about)


def _field(draft: Draft) -> str:
    if draft.field is None:
        return ""
    preset = _line(f"field_preset = {json.dumps(draft.preset)}", "a file of config/fields: measures and mirror")
    if draft.field == field_of(draft.preset):
        return preset
    measures = {name: getattr(draft.field, name) for name in FieldSettings.__struct_fields__ if name != "goal"}
    measures["name"] = draft.name
    lines = [f"{name} = {json.dumps(value)}" for name, value in measures.items()]
    lines[0] = _line(lines[0], "not the preset's measures but these")
    goal = [f"{name} = {json.dumps(value)}" for name, value in msgspec.structs.asdict(draft.field.goal).items()]
    return "\n".join([preset, "", "[field]", *lines, "", "[field.goal]", *goal])


def _source(draft: Draft) -> str:
    if not draft.source:
        return '# [source]\n# uri = "camera:0"                # no camera was chosen; the service\'s own is used'
    if draft.source == PICTURES:
        return _line(f"[source]\nuri = {json.dumps(f'file:{draft.name}')}", "the folder beside this file")
    return f"[source]\nuri = {json.dumps(draft.source)}"


def _camera(camera: DraftCamera | None) -> str:
    if camera is None:
        return ""
    how = _comment(camera.how)
    if camera.pinhole is not None:
        tables = camera_tables(camera.pinhole, camera.size_px, {})
        parts = [
            "\n".join([f"[{name}]", *(f"{key} = {value}" for key, value in values.items())])
            for name, values in tables.items()
        ]
        return "\n".join([how, "\n\n".join(parts)])
    assert camera.homography is not None
    width, height = camera.size_px
    points = [
        f"    {{ name = {json.dumps(point.name)}, pixel_px = {_pair(point.pixel_px)}, "
        f"field_m = {_pair(point.field_m)} }},"
        for point in camera.homography.points
    ]
    position = ", ".join(f"{value:.3f}" for value in camera.homography.position_m)
    return "\n".join(
        [
            how,
            "[camera]",
            f"width_px = {width}",
            f"height_px = {height}",
            'model = "homography"',
            "",
            "[camera.homography]",
            f"position_m = [{position}]",
            "points = [",
            *points,
            "]",
        ]
    )


def _colors(draft: Draft) -> str:
    if not draft.samples and draft.camera is None:
        return ""
    lines = [_line("[colors.classes]", "none by boxes: every class of this venue is by samples"), ""]
    lines.append(_line("[colors.samples]", "measured colors of each class; none: what must not be found"))
    lines += [sample_line(name, colors) for name, colors in draft.samples.items() if colors]
    if draft.sampling is not None:
        found = msgspec.structs.asdict(draft.sampling)
        lines += ["", _line("[colors.sampling]", "found with the samples"), *_values(found)]
    if draft.light is not None:
        lines += [
            "",
            _line("[colors.light]", "the light of the samples"),
            *_values(msgspec.structs.asdict(draft.light)),
        ]
    elif draft.camera is not None:
        lines += ["", _line("[colors.light]", "other light than that of the samples is judged by the carpet")]
        lines += _values({"reference_bgr": draft.camera.reference_bgr})
    return "\n".join(lines)


def _values(table: Mapping[str, object]) -> list[str]:
    """Keys with numbers, lists of numbers, and yes or no."""
    return [f"{key} = {json.dumps(value)}" for key, value in table.items()]


def _robots(draft: Draft) -> str:
    if not draft.pattern:
        return ""
    pattern = _line(f"[robots]\npattern = {json.dumps(draft.pattern)}", "a file of config/patterns")
    height = _line(f"height_m = {draft.robot_height_m!r}", "of the markers over the floor")
    return f"{pattern}\nradius_m = {draft.robot_radius_m!r}\n{height}"


def _pair(pair: tuple[float, float]) -> str:
    return f"[{pair[0]:.2f}, {pair[1]:.2f}]" if max(map(abs, pair)) >= 20.0 else f"[{pair[0]:.4f}, {pair[1]:.4f}]"


def _line(text: str, comment: str) -> str:
    """A line with a comment, in the column of the shipped files."""
    *above, last = text.split("\n")
    return "\n".join([*above, f"{last.ljust(COMMENT_AT - 1)} # {comment}"])


def _comment(text: str) -> str:
    return textwrap.fill(text, WIDTH, initial_indent="# ", subsequent_indent="# ")
