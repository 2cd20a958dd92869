"""A frame to be explained, and what can be asked of it. Slow, and never on the hot path."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from vision_core.geometry import Floats, Mask
from vision_core.models.camera_kernels import field_and_scale, pixel_from_field, pixels_per_square_metre
from vision_core.models.from_settings import robots_of
from vision_core.objects.field_limits import accepted_extents, is_accepted
from vision_core.objects.observation import Observation
from vision_core.objects.robots.finder import RobotFinder
from vision_core.objects.robots.hypothesis_generation import generate_hypotheses, locate_blobs, slot_area_ratio
from vision_core.objects.robots.markers import NO_DIGIT, Marker
from vision_core.patterns.loader import load_pattern
from vision_core.patterns.pattern import TEAM
from vision_core.settings.schema import Settings
from vision_core.types.colors import ColorTable
from vision_core.types.tables import NO_ID, TEAMS, Table

MAX_MISSING = 2
"""Missing patches that are explained, per robot."""
APART = 0.8
"""What is nearer to a robot than this share of its radius is that robot."""
MIN_MERGED = 1.6
"""A blob so many times as large as a patch is two that have run together."""


@dataclass(frozen=True, slots=True)
class Scene:
    """A frame to be explained. Its arrays have the types of the hot path's, so that no kernel is compiled anew."""

    seen: Observation
    """With the blobs of all color classes."""
    table: ColorTable
    robots: Callable[[RobotFinder], Table]
    """The robots that the hot path finds by blobs with a given finder: ROBOT table, shape (n,)."""
    read: Table
    """The frame's robots with an id and a heading, told by their blobs or their shape: ROBOT, shape (n,)."""

    @property
    def blobs(self) -> Table:
        """BLOB table, shape (n,)."""
        return self.seen.blobs


@dataclass(frozen=True, slots=True, eq=False)
class SeenRobots:
    """The robots that a finder finds in a scene, with what it found them by."""

    robots: Table
    """As the hot path gives them, ROBOT, shape (n,)."""
    hypotheses: Table
    """Of the same robots in the order of their confidence, HYPOTHESIS, shape (n,)."""
    found: Table
    """The robots in this order; two of a team with one id still have it. ROBOT, shape (n,)."""
    alike: Mask
    """Which of them another marker of the same team explains about as well, shape (n,)."""
    read: Mask
    """Which of them are among the frame's robots that are read (``Scene.read``), shape (n,)."""
    known: Table
    """Those that are read, then those of ``found`` that are not: ROBOT, shape (n,)."""

    def id_of(self, number: int) -> int:
        """The id of a robot in this order; NO_ID when another one of its team has the same."""
        row = self.found[number]
        same = (self.robots["team"] == row["team"]) & (self.robots["x_m"] == row["x_m"])
        return int(self.robots["id"][same & (self.robots["y_m"] == row["y_m"])][0])

    def lacks_id(self, number: int) -> bool:
        """Has a robot in this order no id, whatever might have told it?"""
        return not self.read[number] and self.id_of(number) == NO_ID


def seen_robots(scene: Scene, finder: RobotFinder) -> SeenRobots:
    """What a finder finds in a scene."""
    robots = scene.robots(finder)
    buffers = finder.buffers
    chosen = buffers.hypotheses[buffers.selected[: len(robots)]].copy()
    found = buffers.found[: len(robots)].copy()
    away = np.hypot(*(found[axis][:, None] - scene.read[axis] for axis in ("x_m", "y_m")))
    radii = np.array([finder.markers[row["marker"]].radius_m for row in chosen])
    read = (away < APART * radii[:, None]).any(axis=1)
    known = np.concatenate([scene.read, found[~read]])
    return SeenRobots(robots, chosen, found, buffers.alike[: len(robots)].copy(), read, known)


def hypotheses_of(scene: Scene, finder: RobotFinder, marker: Marker) -> Table:
    """All hypotheses of a team, however low their score, best first."""
    gates = finder.gates._replace(min_confidence=0.0)
    listed = locate_blobs(scene.seen, marker, gates, finder.buffers)
    count = generate_hypotheses(scene.seen, listed, marker, gates, finder.buffers, 0)
    rows: Table = finder.buffers.hypotheses[:count].copy()
    return rows[np.argsort(-rows["score"], kind="stable")]


def anchor_area_ratios(scene: Scene, finder: RobotFinder, marker: Marker, blobs: Any) -> Any:
    """Areas of blobs over the anchor's."""
    gates = finder.gates._replace(min_area=0.0)
    finder.buffers.places[marker.number] = 0.0
    locate_blobs(scene.seen, marker, gates, finder.buffers)
    return finder.buffers.places[marker.number, blobs, 2] / marker.anchor_area_m2


def what_is_missing(scene: Scene, marker: Marker, hypothesis: Any, settings: Settings) -> str:
    """Which of a hypothesis' patches are missing, and what is seen in their places."""
    missing = missing_slots(marker, hypothesis)
    pattern = pattern_name(settings, marker)
    found = f"{1 + int(hypothesis['matched'])} of the {1 + len(marker.slots_m)} patches of pattern {pattern} are found"
    if not missing:
        return found
    merged = {slot: where for slot in missing if (where := merged_into(scene, marker, hypothesis, slot, settings))}
    said = [_merged_in_words(marker, merged)] if merged else []
    said += [
        _what_is_at(scene, marker, hypothesis, slot, settings) for slot in missing[:MAX_MISSING] if slot not in merged
    ]
    return f"{found}; {'; '.join(said)}"


def missing_slots(marker: Marker, hypothesis: Any) -> list[int]:
    """The slots of a hypothesis without a blob."""
    return [slot for slot in range(len(marker.slots_m)) if hypothesis["slot_blobs"][slot] < 0]


def _merged_in_words(marker: Marker, merged: dict[int, str]) -> str:
    """Which slots' patches have run together."""
    names = [side_of(*marker.slots_m[slot]) for slot in merged]
    which = f"the {names[0]} patch seems to have run together with another one"
    if len(names) > 1:
        which = f"the {' and the '.join(names)} patch seem to have run together"
    return f"{which}: {next(iter(merged.values()))}, the picture is too coarse for the gap between"


def _what_is_at(scene: Scene, marker: Marker, hypothesis: Any, slot: int, settings: Settings) -> str:
    """What is seen where a slot's patch should be."""
    a, b = marker.slots_m[slot]
    x, y = place_of_slot(scene, marker, hypothesis, slot)
    patch, wanted = f"the {side_of(a, b)} patch", " or ".join(_colors_of(scene.table, marker, slot))
    off = _blobs_off(scene, marker, hypothesis, slot)
    scale2 = pixels_per_square_metre(scene.seen.camera, hypothesis["x_m"], hypothesis["y_m"], marker.height_m)
    if not (off <= _tolerance_px(settings, scale2)).any():
        return f"{patch} is missing: there is nothing {wanted} at ({x:.0f}, {y:.0f}) px"
    blob = int(np.argmin(off))
    color = int(scene.blobs["color"][blob])
    if marker.digits[slot, color] == NO_DIGIT:
        return f"{patch} is {scene.table.names[color]}, not {wanted}"
    place = field_and_scale(scene.seen.camera, scene.blobs["x_px"][blob], scene.blobs["y_px"][blob], marker.height_m)
    if not is_accepted(*place[:2], marker.radius_m, accepted_extents(settings.field, settings.robots.margin_m)):
        return f"{patch} lies off the field, farther than robots.margin_m = {settings.robots.margin_m:g} m"
    ratio = slot_area_ratio(marker.areas_m2, slot, float(scene.blobs["area_px"][blob] / scale2))
    return f"{patch} has {ratio:.2g} times the expected area"


def merged_into(scene: Scene, marker: Marker, hypothesis: Any, slot: int, settings: Settings) -> str:
    """The blob into which a missing slot's patch and another one have run, in words.

    Empty when a blob lies in the slot's place, or none is as large as two patches.
    """
    scale2 = pixels_per_square_metre(scene.seen.camera, hypothesis["x_m"], hypothesis["y_m"], marker.height_m)
    if _blobs_off(scene, marker, hypothesis, slot).min(initial=np.inf) <= _tolerance_px(settings, scale2):
        return ""
    x, y = pixel_from_field(scene.seen.camera, hypothesis["x_m"], hypothesis["y_m"], marker.height_m)
    for blob in scene.blobs:
        is_own = math.hypot(blob["x_px"] - x, blob["y_px"] - y) <= marker.radius_m * math.sqrt(scale2)
        is_its_color = marker.digits[slot, blob["color"]] != NO_DIGIT and blob["color"] != marker.anchor_class
        if is_own and is_its_color and blob["area_px"] / scale2 >= MIN_MERGED * marker.areas_m2[slot, 1]:
            color = scene.table.names[int(blob["color"])]
            return f"a {color} blob at ({blob['x_px']:.0f}, {blob['y_px']:.0f}) px is as large as two"
    return ""


def _blobs_off(scene: Scene, marker: Marker, hypothesis: Any, slot: int) -> Floats:
    """How far every blob is from where a hypothesis has a slot [px]."""
    x, y = place_of_slot(scene, marker, hypothesis, slot)
    off: Floats = np.hypot(scene.blobs["x_px"] - x, scene.blobs["y_px"] - y)
    return off


def _tolerance_px(settings: Settings, scale2: float) -> float:
    return settings.robots.dot_tolerance_m * math.sqrt(scale2)


def _colors_of(table: ColorTable, marker: Marker, slot: int) -> list[str]:
    """The color classes that a slot's patch may have."""
    return [table.names[color] for color in np.flatnonzero(marker.digits[slot] != NO_DIGIT)]


def place_of_slot(scene: Scene, marker: Marker, hypothesis: Any, slot: int) -> tuple[float, float]:
    """Where a hypothesis has a slot in the picture [px]."""
    c, s = math.cos(hypothesis["heading_rad"]), math.sin(hypothesis["heading_rad"])
    a, b = marker.slots_m[slot]
    x_m, y_m = hypothesis["x_m"] + c * a - s * b, hypothesis["y_m"] + s * a + c * b
    x, y = pixel_from_field(scene.seen.camera, x_m, y_m, marker.height_m)
    return float(x), float(y)


def side_of(x: float, y: float) -> str:
    """Where a place in robot space is, in words."""
    along = "front" if x > abs(y) / 3.0 else "back" if x < -abs(y) / 3.0 else ""
    across = "left" if y > abs(x) / 3.0 else "right" if y < -abs(x) / 3.0 else ""
    return " ".join(word for word in (along, across) if word) or "middle"


def code_of(scene: Scene, marker: Marker, hypothesis: Any, settings: Settings) -> str:
    """The code that a hypothesis shows, as initials of its colors and shapes."""
    letters, shaped = [], shaped_slots(settings, marker)
    for slot in range(len(marker.slots_m)):
        if marker.place_values[slot]:
            letters.append(scene.table.names[int(scene.blobs["color"][hypothesis["slot_blobs"][slot]])][0])
        if slot in shaped:
            letters.append(shape_names(settings, marker)[hypothesis["shapes"][slot]][0])
    return "".join(letters).upper()


def counted(count: int, noun: str) -> str:
    """A number of things in words."""
    return f"{count} {noun if count == 1 else f'{noun}s'}"


def pattern_name(settings: Settings, marker: Marker) -> str:
    """Name of a marker's pattern in the settings."""
    return patterns_of(settings)[marker.number]


def patterns_of(settings: Settings) -> list[str]:
    """The names of the patterns of all markers, in their order."""
    return [name for team in TEAMS for name in robots_of(settings.robots, team).patterns]


def shape_names(settings: Settings, marker: Marker) -> list[str]:
    """The names of the shapes of a marker's code."""
    return [shape.name for shape in load_pattern(pattern_name(settings, marker)).code.shapes]


def shaped_slots(settings: Settings, marker: Marker) -> list[int]:
    """The slots of a marker whose shape is a letter of the id."""
    slots = [patch for patch in load_pattern(pattern_name(settings, marker)).patches if patch.color != TEAM]
    return [slot for slot, patch in enumerate(slots) if patch.shapes]


def pixel_of(scene: Scene, blob: int) -> str:
    """Where a blob is, in words."""
    return f"({scene.blobs['x_px'][blob]:.0f}, {scene.blobs['y_px'][blob]:.0f}) px"
