"""Loads marker patterns from files (``config/patterns``, or one's own) and checks them.

Robot space: origin at the robot's center, x forward, y left; millimetres. Ambiguous patterns are refused: see
``docs/patterns.md``.
"""

from collections.abc import Iterator
from functools import lru_cache
from pathlib import Path

import msgspec
import numpy as np

from vision_core.errors import SettingsError
from vision_core.patterns.checks import MIN_WIDTH_MM, check_geometry, check_letters, check_looks, check_patch
from vision_core.patterns.geometry import centroid_mm, depth_mm, overlap_mm
from vision_core.patterns.pattern import Patch, Pattern
from vision_core.venues.loader import Layer, find_file, read_layer


def load_pattern(name: str) -> Pattern:
    """A pattern by its file's name in config/patterns, or by a path.

    A process parses and checks each file once, and again when the file has changed. Raises SettingsError.
    """
    path = find_file("patterns", name)
    try:
        changed_ns = path.stat().st_mtime_ns
    except (OSError, ValueError):  # ValueError: a NUL character in the name
        changed_ns = 0  # reading it says why
    return _loaded(path.absolute(), changed_ns)


@lru_cache(maxsize=32)
def _loaded(path: Path, _changed_ns: int) -> Pattern:
    layer = read_layer(path)
    try:
        pattern = msgspec.convert(layer.table, Pattern)
    except msgspec.ValidationError as error:
        raise SettingsError(f"pattern {layer.name}", found=str(error)) from None
    check_letters(layer.name, pattern)
    pattern = _laid_over(layer, _in_shapes(layer, pattern))
    check_geometry(layer.name, pattern)
    check_looks(layer.name, pattern)
    return pattern


def _in_shapes(layer: Layer, pattern: Pattern) -> Pattern:
    """The pattern in which every patch whose shape is a letter of the id knows its shapes."""
    if any(patch.shapes for patch in pattern.patches):
        accepted = "shapes_at_mm, and the shapes in code.shapes"
        raise SettingsError(f"pattern {layer.name}: shapes", found="in a patch", accepted=accepted)
    patches = [
        patch if patch.shapes_at_mm is None else _in_each_shape(layer, number, patch, pattern)
        for number, patch in enumerate(pattern.patches, start=1)
    ]
    return msgspec.structs.replace(pattern, patches=tuple(patches))


def _in_each_shape(layer: Layer, number: int, patch: Patch, pattern: Pattern) -> Patch:
    """A patch with its shapes at its place, and the largest circle that all of them contain round their middle."""
    assert patch.shapes_at_mm is not None
    x, y = patch.shapes_at_mm
    shapes = []
    for shape in pattern.code.shapes:
        circle = shape.circle_mm and (shape.circle_mm[0] + x, shape.circle_mm[1] + y, shape.circle_mm[2])
        polygon = shape.polygon_mm and tuple((a + x, b + y) for a, b in shape.polygon_mm)
        laid = Patch(color=patch.color, circle_mm=circle, polygon_mm=polygon)
        check_patch(f"pattern {layer.name}: patch {number}, shape {shape.name}", number, laid, pattern.robot)
        shapes.append(laid)
    middle = np.array([centroid_mm(shape) for shape in shapes]).mean(axis=0)
    depth = min(float(depth_mm(shape, middle[None])[0]) for shape in shapes)
    if 2.0 * depth < MIN_WIDTH_MM:
        raise SettingsError(
            f"pattern {layer.name}: code.shapes",
            found="shapes that have no room in common in their middle",
            accepted="shapes that all cover the middle of the patch's place",
        )
    core = (float(middle[0]), float(middle[1]), 2.0 * depth)
    return msgspec.structs.replace(patch, circle_mm=core, shapes=tuple(shapes))


def _laid_over(layer: Layer, pattern: Pattern) -> Pattern:
    """The pattern in which every patch knows what lies over it."""
    if any(patch.hidden_by for patch in pattern.patches):
        raise SettingsError(f"pattern {layer.name}: hidden_by", found="a list", accepted="lies_over = true above")
    patches = [
        msgspec.structs.replace(patch, hidden_by=tuple(_covers_of(patch, pattern.patches[number:])))
        for number, patch in enumerate(pattern.patches, start=1)
    ]
    return msgspec.structs.replace(pattern, patches=tuple(patches))


def _covers_of(patch: Patch, above: tuple[Patch, ...]) -> Iterator[Patch]:
    """Which of the patches above hide a part of a patch."""
    return (cover for cover in above if cover.lies_over and overlap_mm(patch, cover) > 0.0)
