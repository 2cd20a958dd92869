"""Why robots are not seen, or not read: in words, for people. Slow, and never part of the hot path."""

import contextlib
import math
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import msgspec
import numpy as np

from vision_core.errors import SettingsError
from vision_core.geometry import Bytes
from vision_core.models.camera_kernels import CameraMap, pixel_from_field, pixels_per_square_metre
from vision_core.models.from_settings import robots_of
from vision_core.objects.robots.buffers import ANCHOR, FIRST_SLOT, HEADING, MATCHED, SCORE, X, Y, take_memory
from vision_core.objects.robots.finder import RobotFinder, gates_from, robot_finder
from vision_core.objects.robots.hypothesis_generation import place_blobs, propose
from vision_core.objects.robots.markers import REFUSED, Marker, marker_of
from vision_core.objects.robots.pose_refinement import code_of
from vision_core.patterns.loader import load_pattern, scaled
from vision_core.settings.schema import Settings, TeamRobotSettings
from vision_core.types.colors import ColorTable
from vision_core.types.tables import NO_ID, TEAMS, Table
from vision_core.venues.loader import config_folder

NUMERALS = {2: "two", 3: "three", 4: "four"}
SAME_PLACE_M = 0.5
"""In robots' radii: an anchor that is nearer to a seen robot's center belongs to it."""
SIZES = tuple(round(1.06**step, 2) for step in range(-12, 13) if step)
"""Tried of markers, when they are not read: half to double."""
BETTER = 1.3
"""So much more must another pattern explain to be named."""
MAX_SAID = 3
"""Robots that are not read of which something is said, per team."""


@dataclass(frozen=True, slots=True)
class Scene:
    """A frame's blobs and what looks at them: arrays of the forms that the hot path has, or kernels compile anew."""

    blobs: Table
    """BLOB table, shape (n,)."""
    pixels: Bytes
    table: ColorTable
    camera: CameraMap

    robots: Callable[[RobotFinder], Table]
    """What the hot path finds with another finder, ROBOT table of shape (n,)."""


def explain_robots(scene: Scene, settings: Settings) -> list[str]:
    """Why there are no robots, or why some lack an id; empty when every robot is read. At most a few sentences."""
    finder = robot_finder(settings, scene.table)
    robots = scene.robots(finder)
    reasons = []
    for marker in finder.markers:
        own = robots[robots["team"] == marker.team]
        if not len(robots):
            reasons.append(_why_none(scene, finder, marker, settings))
        elif (own["id"] == NO_ID).any() or not len(own):
            reasons += _why_unread(scene, finder, marker, own, settings)
    if not len(robots) or (robots["id"] == NO_ID).any():
        reasons += _other_patterns(scene, robots, settings)
    return reasons


def _why_none(scene: Scene, finder: RobotFinder, marker: Marker, settings: Settings) -> str:
    """What came nearest to a robot of a team, and what it lacks."""
    name, gates = TEAMS[marker.team], finder.gates
    blobs = np.flatnonzero(scene.blobs["color"] == marker.anchor_class)
    if not len(blobs):
        return f"no {name} robot: no blob of class {name}"
    shares = _shares(scene, finder, marker, blobs)
    right = (shares >= gates.min_area) & (shares <= gates.max_area)
    if not right.any():
        nearest = int(np.argmin(np.abs(np.log(np.maximum(shares, 1e-9)))))
        return (
            f"no {name} robot: {len(blobs)} {_plural(len(blobs), 'blob')} of class {name}, none of the right size; the "
            f"nearest, at {_pixel(scene, blobs[nearest])}, has {shares[nearest]:.2g} of the area predicted "
            f"({gates.min_area:g} to {gates.max_area:g} are accepted): robots.height_m, the camera, or another pattern?"
        )
    row = _best_row(scene, finder, marker)
    if row is None or row[MATCHED] == 0 < len(marker.slots_m):
        return (
            f"no {name} robot: {int(right.sum())} {_plural(int(right.sum()), 'blob')} of class {name} and of the right "
            f"size, the first at {_pixel(scene, blobs[right][0])}, with no patch of {_pattern(settings, marker)} round"
        )
    return (
        f"no {name} robot: the best, at {_pixel(scene, int(row[ANCHOR]))}, has confidence {row[SCORE]:.2f}, below "
        f"robots.min_confidence {settings.robots.min_confidence:g}: {_what_lacks(scene, marker, row, settings)}"
    )


def _why_unread(
    scene: Scene, finder: RobotFinder, marker: Marker, robots: Table, settings: Settings
) -> list[str]:  # fmt: skip
    """What keeps a team's robots from being read."""
    name, rows = TEAMS[marker.team], _rows(scene, finder, marker)
    reasons, worn = [], Counter[int]()
    for robot in robots:
        near = [row for row in rows if math.hypot(row[X] - robot["x_m"], row[Y] - robot["y_m"]) < _same(marker)]
        best = max(near, key=lambda row: float(row[SCORE]), default=None)
        if robot["id"] != NO_ID or best is None:
            continue
        at = f"{name} robot at ({robot['x_px']:.0f}, {robot['y_px']:.0f}) px"
        if best[MATCHED] < len(marker.slots_m):
            reasons.append(f"{at} is not read: {_what_lacks(scene, marker, best, settings)}")
        elif (number := code_of(scene.blobs, marker, best)) == NO_ID:
            reasons.append(f"{at} wears {_code(scene, marker, best)}, which is no id of {_pattern(settings, marker)}")
        else:
            worn[number] += 1
    twice = [
        f"{NUMERALS.get(count, count)} robots wear {name} {number}: {'both' if count == 2 else 'all'} lose it"
        for number, count in worn.items()
        if count > 1
    ]
    return reasons[:MAX_SAID] + twice


def _other_patterns(scene: Scene, robots: Table, settings: Settings) -> list[str]:
    """The shipped pattern, or the size of the own one, that would read most robots, if it reads clearly more."""
    best, best_gain, read = "", BETTER * _gain(robots), 0
    for name, finder in (*_finders_of_other_patterns(scene, settings), *_finders_of_other_sizes(scene, settings)):
        seen = scene.robots(finder)
        ids = int((seen["id"] != NO_ID).sum())
        if ids and (gain := _gain(seen)) > best_gain:
            best, best_gain, read = name, gain, ids
    return [f"{best} {read} {_plural(read, 'robot')} would be read"] if best else []


def _finders_of_other_patterns(scene: Scene, settings: Settings) -> Iterator[tuple[str, RobotFinder]]:
    """Of every shipped pattern that wears no colors but those that have a class here."""
    worn = {robots_of(settings.robots, team).pattern for team in TEAMS}
    for path in sorted((config_folder() / "patterns").glob("*.toml")):
        if path.stem in worn:
            continue
        shape = load_pattern(path.stem).robot
        team = TeamRobotSettings(
            pattern=path.stem, outline=shape.outline, radius_m=shape.radius_m, height_m=shape.height_m
        )
        other = msgspec.structs.replace(settings.robots, blue=team, yellow=team)
        with contextlib.suppress(SettingsError):
            finder = robot_finder(msgspec.structs.replace(settings, robots=other), scene.table)
            yield f"markers of another league? With robots.pattern {path.stem!r}", finder


def _finders_of_other_sizes(scene: Scene, settings: Settings) -> Iterator[tuple[str, RobotFinder]]:
    """Of markers that look larger or smaller than they are: what a wrong camera makes of them."""
    memory = take_memory(settings.blobs.max_blobs)
    for factor in SIZES:
        blue, yellow = (
            marker_of(
                scaled(load_pattern(robots.pattern), factor), robots, team, number, scene.table,
                settings.robots.dot_tolerance_m,
            )
            for number, team in enumerate(TEAMS)
            for robots in [robots_of(settings.robots, team)]
        )  # fmt: skip
        area = f"blobs have {factor**2:.1f} of the area predicted"
        name = f"wrong camera height, or size of the field? {area}; were markers {factor:.2f} times as large,"
        yield name, RobotFinder((blue, yellow), gates_from(settings), memory)


def _gain(robots: Table) -> float:
    """How well robots explain what is seen: their confidences, those without an id counting little."""
    return float((robots["confidence"] * np.where(robots["id"] != NO_ID, 1.0, 0.2)).sum())


def _rows(scene: Scene, finder: RobotFinder, marker: Marker) -> Table:
    """All hypotheses of a team, however poor, best first."""
    gates = finder.gates._replace(min_confidence=0.0)
    listed = place_blobs(scene.blobs, len(scene.blobs), scene.camera, marker, gates, finder.memory)
    count = propose(
        scene.blobs, listed, scene.pixels, scene.table.classes, scene.camera, marker, gates, finder.memory, 0
    )  # fmt: skip
    rows: Table = finder.memory.rows[:count].copy()
    return rows[np.argsort(-rows[:, SCORE], kind="stable")]


def _best_row(scene: Scene, finder: RobotFinder, marker: Marker) -> Any:
    rows = _rows(scene, finder, marker)
    return rows[0] if len(rows) else None


def _shares(scene: Scene, finder: RobotFinder, marker: Marker, blobs: Any) -> Any:
    """Areas of blobs over the anchor's."""
    gates = finder.gates._replace(min_area=0.0)
    finder.memory.places[marker.team] = 0.0
    place_blobs(scene.blobs, len(scene.blobs), scene.camera, marker, gates, finder.memory)
    return finder.memory.places[marker.team, blobs, 2] / marker.anchor_area_m2


def _what_lacks(scene: Scene, marker: Marker, row: Any, settings: Settings) -> str:
    """Which of a hypothesis' patches are not there, and what is in their places."""
    missing = [slot for slot in range(len(marker.slots_m)) if row[FIRST_SLOT + slot] < 0]
    there = f"{1 + int(row[MATCHED])} of {1 + len(marker.slots_m)} patches of {_pattern(settings, marker)}"
    if not missing:
        return there
    what = "; ".join(_what_is_at(scene, marker, row, slot, settings) for slot in missing[:2])
    return f"{there}; {what}"


def _what_is_at(scene: Scene, marker: Marker, row: Any, slot: int, settings: Settings) -> str:
    """What is seen where a slot's patch should be."""
    c, s = math.cos(row[HEADING]), math.sin(row[HEADING])
    a, b = marker.slots_m[slot]
    x, y = pixel_from_field(scene.camera, row[X] + c * a - s * b, row[Y] + s * a + c * b, marker.height_m)
    name, wanted = _side(a, b), " or ".join(_worn(scene.table, marker, slot))
    off = np.hypot(scene.blobs["x_px"] - x, scene.blobs["y_px"] - y)
    reach = settings.robots.dot_tolerance_m * math.sqrt(_scale(scene, marker, row))
    if not (off <= reach).any():
        return f"the patch {name} is missing: nothing {wanted} at ({x:.0f}, {y:.0f}) px"
    blob = int(np.argmin(off))
    color = int(scene.blobs["color"][blob])
    if marker.digits[slot, color] == REFUSED:
        return f"the patch {name} is {scene.table.names[color]}, not {wanted}"
    share = float(scene.blobs["area_px"][blob] / _scale(scene, marker, row) / marker.areas_m2[slot])
    return f"the patch {name} has {share:.2g} of the area predicted"


def _scale(scene: Scene, marker: Marker, row: Any) -> float:
    """Pixels per square metre at a hypothesis."""
    return pixels_per_square_metre(scene.camera, row[X], row[Y], marker.height_m)


def _worn(table: ColorTable, marker: Marker, slot: int) -> list[str]:
    return [table.names[color] for color in np.flatnonzero(marker.digits[slot] != REFUSED)]


def _side(x: float, y: float) -> str:
    """Where a place in robot space is, in words."""
    along = "front" if x > abs(y) / 3.0 else "back" if x < -abs(y) / 3.0 else ""
    across = "left" if y > abs(x) / 3.0 else "right" if y < -abs(x) / 3.0 else ""
    return " ".join(word for word in (along, across) if word) or "in the middle"


def _code(scene: Scene, marker: Marker, row: Any) -> str:
    letters = [
        scene.table.names[scene.blobs["color"][int(row[FIRST_SLOT + slot])]][0].upper()
        for slot in range(len(marker.slots_m))
        if marker.places[slot]
    ]
    return "".join(letters)


def _same(marker: Marker) -> float:
    return SAME_PLACE_M * marker.radius_m


def _pattern(settings: Settings, marker: Marker) -> str:
    return robots_of(settings.robots, TEAMS[marker.team]).pattern


def _pixel(scene: Scene, blob: int) -> str:
    return f"({scene.blobs['x_px'][blob]:.0f}, {scene.blobs['y_px'][blob]:.0f}) px"


def _plural(count: int, noun: str) -> str:
    return noun if count == 1 else f"{noun}s"
