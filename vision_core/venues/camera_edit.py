"""Writes a calibrated camera into a settings file, and leaves everything else in it as it is."""

import tomllib
from collections.abc import Mapping, Sequence
from pathlib import Path

from vision_core.errors import SettingsError
from vision_core.settings.layers import Layer
from vision_core.settings.schema import PinholeSettings
from vision_core.venues.loader import settings_from_layers
from vision_core.venues.toml_edit import replace_file, with_values


def camera_tables(
    camera: PinholeSettings, size_px: tuple[int, int], measures_m: Mapping[str, float]
) -> dict[str, dict[str, str]]:
    """The tables of a venue's file: values as they are written in TOML, by key. measures_m: of the field, if known."""
    lens = {name: _number(getattr(camera, name)) for name in camera.__struct_fields__}
    whole = {"width_px": str(size_px[0]), "height_px": str(size_px[1]), "model": '"pinhole"'}
    field = {"field": {name: _number(value) for name, value in measures_m.items()}} if measures_m else {}
    return {"camera": whole, "camera.pinhole": lens, **field}


def camera_lines(camera: PinholeSettings, size_px: tuple[int, int], measures_m: Mapping[str, float]) -> str:
    """The same as lines that can be pasted."""
    parts = []
    for table, values in camera_tables(camera, size_px, measures_m).items():
        parts.append("\n".join([f"[{table}]", *(f"{key} = {value}" for key, value in values.items())]))
    return "\n\n".join(parts)


def save_camera(
    layers: Sequence[Layer],
    target: Layer,
    camera: PinholeSettings,
    size_px: tuple[int, int],
    measures_m: Mapping[str, float],
) -> None:
    """Write a camera into one of the files that settings come from.

    layers: of ``layers_of``; target: the one to edit. The settings are checked first. The file is replaced in one step.
    Raises SettingsError when they would break a rule, the file's tables are written in a form that cannot be edited,
    or it cannot be written; then nothing is changed.
    """
    text = target.text
    for table, values in camera_tables(camera, size_px, measures_m).items():
        text = with_values(text, table, values)
    asked = f"--save to {target.name}"
    try:
        edited = Layer(target.name, tomllib.loads(text), text, target.kind)
        settings = settings_from_layers([edited if layer is target else layer for layer in layers])
        saved = settings.camera.pinhole
    except tomllib.TOMLDecodeError:
        saved = None
    if saved != camera:
        accepted = f"tables [camera] and [camera.pinhole]; write into it: {camera_lines(camera, size_px, measures_m)}"
        raise SettingsError(asked, found="camera in another form, or in a later file", accepted=accepted)
    replace_file(Path(target.name), text, asked)


def _number(value: float | Sequence[float]) -> str:
    if isinstance(value, float | int):
        return repr(float(value))
    return f"[{', '.join(repr(float(part)) for part in value)}]"
