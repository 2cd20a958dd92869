"""Writes a calibrated camera, a lens, or a mirror into a settings file, and leaves everything else in it as it is."""

import tomllib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TypeAlias

from vision_core.errors import SettingsError
from vision_core.models.from_settings import mirror_of, scope_of
from vision_core.models.mirror import Mirror
from vision_core.settings.layers import Layer
from vision_core.settings.schema import LensSettings, PinholeSettings, Settings
from vision_core.types.objects import Team
from vision_core.venues.loader import settings_from_layers
from vision_core.venues.toml_edit import replace_file, with_values

Tables: TypeAlias = dict[str, dict[str, str]]
"""Values as they are written in TOML, by table and key."""


def camera_tables(camera: PinholeSettings, size_px: tuple[int, int], measures_m: Mapping[str, float]) -> Tables:
    """The tables of a venue's file. measures_m: of the field, if known."""
    lens = {name: _number(getattr(camera, name)) for name in camera.__struct_fields__}
    whole = {"width_px": str(size_px[0]), "height_px": str(size_px[1]), "model": '"pinhole"'}
    field = {"field": {name: _number(value) for name, value in measures_m.items()}} if measures_m else {}
    return {"camera": whole, "camera.pinhole": lens, **field}


def lens_tables(lens: LensSettings) -> Tables:
    """The table of a venue's file for a lens that was measured with a board."""
    values = {name: _number(getattr(lens, name)) for name in lens.__struct_fields__}
    return {"camera.lens": values | {"size_px": repr(list(lens.size_px))}}


def mirror_tables(mirror: Mirror, team: Team | None = None, number: int | None = None) -> Tables:
    """The table of a venue's file for the mirror of a robot, of a team's robots, or without a team of the field's."""
    own = f'.robots."{scope_of(team, number)}"' if number is not None else f".{scope_of(team)}" if team else ""
    return {f"mirror{own}": {name: _number(value) for name, value in asdict(mirror).items()}}


def lines_of(tables: Tables) -> str:
    """The same as lines that can be pasted."""
    parts = []
    for table, values in tables.items():
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
    _save(layers, target, camera_tables(camera, size_px, measures_m), lambda saved: saved.camera.pinhole == camera)


def save_lens(layers: Sequence[Layer], target: Layer, lens: LensSettings) -> None:
    """Write a lens that was measured with a board into one of the files; arguments and errors as of ``save_camera``."""
    _save(layers, target, lens_tables(lens), lambda saved: saved.camera.lens == lens)


def save_mirror(
    layers: Sequence[Layer], target: Layer, mirror: Mirror, team: Team | None = None, number: int | None = None
) -> None:
    """Write a mirror into one of the files; team and number as of ``mirror_tables``, others as of ``save_camera``."""
    tables = mirror_tables(mirror, team, number)
    _save(layers, target, tables, lambda saved: mirror_of(saved.mirror, team, number) == mirror)


def _save(layers: Sequence[Layer], target: Layer, tables: Tables, is_saved: Callable[[Settings], bool]) -> None:
    text = target.text
    for table, values in tables.items():
        text = with_values(text, table, values)
    asked = f"--save to {target.name}"
    try:
        edited = Layer(target.name, tomllib.loads(text), text, target.kind)
        settings = settings_from_layers([edited if layer is target else layer for layer in layers])
    except tomllib.TOMLDecodeError:
        settings = None
    if settings is None or not is_saved(settings):
        heads = " and ".join(f"[{table}]" for table in tables)
        accepted = f"tables {heads}; write into it: {lines_of(tables)}"
        raise SettingsError(asked, found="values in another form, or in a later file", accepted=accepted)
    replace_file(Path(target.name), text, asked)


def _number(value: float | Sequence[float]) -> str:
    if isinstance(value, float | int):
        return repr(float(value))
    return f"[{', '.join(repr(float(part)) for part in value)}]"
