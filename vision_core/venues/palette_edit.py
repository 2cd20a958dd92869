"""Writes colors into a settings file, and leaves everything else in it as it is."""

import json
import re
import tomllib
from collections.abc import Mapping, Sequence
from pathlib import Path

from vision_core.errors import SettingsError
from vision_core.settings.layers import Layer
from vision_core.settings.schema import ColorSettings
from vision_core.venues.loader import settings_from_layers
from vision_core.venues.toml_edit import ANY_HEADER, assignment, replace_file, without_table

BARE_KEY = re.compile(r"[A-Za-z0-9_-]+")
HEADER = re.compile(r"^\s*\[\s*colors\s*\.\s*samples\s*\]")


def sample_line(name: str, colors: Sequence[str]) -> str:
    """A class and its samples as a line of TOML; colors: "#rrggbb"."""
    key = name if BARE_KEY.fullmatch(name) else json.dumps(name, ensure_ascii=False)
    return f"{key} = [{', '.join(json.dumps(color) for color in colors)}]"


def sample_table(samples: Mapping[str, Sequence[str]]) -> str:
    """All classes as the table ``[colors.samples]``."""
    return "\n".join(["[colors.samples]", *(sample_line(name, colors) for name, colors in samples.items())])


def save_samples(path: Path, text: str, samples: Mapping[str, Sequence[str]], name: str) -> None:
    """Write the samples of one class into a settings file.

    text: the file's content; samples: those of all classes, which are written when the file has no table of them yet.
    The file is replaced in one step. Raises SettingsError when its table is written in a form that cannot be edited, or
    the file cannot be written.
    """
    edited = _edited(text, samples, name)
    try:
        saved = tomllib.loads(edited)["colors"]["samples"].get(name)
    except (ValueError, KeyError, AttributeError):
        saved = None
    if saved != list(samples[name]):
        accepted = (
            f"a table [colors.samples] with one class per line; write into it: {sample_line(name, samples[name])}"
        )
        raise SettingsError(f"--save to {path}", found="colors.samples in another form", accepted=accepted)
    replace_file(path, edited, f"--save to {path}")


def color_tables(colors: ColorSettings) -> str:
    """Colors that were found in pictures as tables of a venue's file: light, samples, and no class by ranges."""
    light, sampling = colors.light, colors.sampling
    wanted = (light.black_bgr, light.reference_bgr or (), light.gain_bgr)
    black, reference, gains = (
        ", ".join(f"{level:.{digits}f}" for level in row) for row, digits in zip(wanted, (1, 1, 3), strict=True)
    )
    return "\n".join(
        [
            "[colors.light]                     # the light that the samples were measured in",
            f"black_bgr = [{black}]",
            f"band = [{light.band[0]:g}, {light.band[1]:g}]",
            f"reference_bgr = [{reference}]",
            f"gain_bgr = [{gains}]",
            f"white_balance = {'true' if light.white_balance else 'false'}",
            f"margin_m = {light.margin_m:.3f}",
            "",
            "[colors.classes]                   # none by ranges",
            "",
            "[colors.sampling]",
            f"spread = {sampling.spread:g}",
            f"tolerance = {sampling.tolerance:g}",
            "",
            sample_table(colors.samples),
        ]
    )


def save_colors(layers: Sequence[Layer], target: Layer, colors: ColorSettings) -> None:
    """Write colors that were found in pictures into one of the files that settings come from.

    layers: of ``layers_of``; target: the one to edit; its classes by ranges and its samples are replaced. The settings
    are checked first. The file is replaced in one step. Raises SettingsError when they would break a rule, or the file
    cannot be written; then nothing is changed.
    """
    text = target.text
    for table in ("colors.light", "colors.classes", "colors.sampling", "colors.samples"):
        text = without_table(text, table)
    text = f"{text.rstrip()}\n\n{color_tables(colors)}\n"
    asked = f"--save to {target.name}"
    try:
        edited = Layer(target.name, tomllib.loads(text), text, target.kind)
        saved = settings_from_layers([edited if layer is target else layer for layer in layers]).colors
    except tomllib.TOMLDecodeError:
        saved = None
    if saved is None or saved.samples != colors.samples or saved.classes:
        accepted = "tables [colors.classes] and [colors.samples] of their own, in the last file that has colors"
        raise SettingsError(asked, found="colors in another form, or in a later file", accepted=accepted)
    replace_file(Path(target.name), text, asked)


def _edited(text: str, samples: Mapping[str, Sequence[str]], name: str) -> str:
    lines = text.splitlines()
    headers = [number for number, line in enumerate(lines) if HEADER.match(line)]
    if not headers:
        gap = [""] if lines and lines[-1].strip() else []
        return "\n".join([*lines, *gap, sample_table(samples), ""])
    start = headers[0] + 1
    end = next((number for number in range(start, len(lines)) if ANY_HEADER.match(lines[number])), len(lines))
    first, last = assignment(lines, start, end, name)
    return "\n".join([*lines[:first], sample_line(name, samples[name]), *lines[last:], ""])
