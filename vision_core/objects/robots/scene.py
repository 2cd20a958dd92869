"""A frame to be explained, and what can be asked of it. Slow, and never on the hot path."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from vision_core.models.camera_kernels import pixel_from_field, pixels_per_square_metre
from vision_core.models.from_settings import robots_of
from vision_core.objects.observation import Observation
from vision_core.objects.robots.finder import RobotFinder
from vision_core.objects.robots.hypothesis_generation import generate_hypotheses, locate_blobs
from vision_core.objects.robots.markers import NO_DIGIT, Marker
from vision_core.settings.schema import Settings
from vision_core.types.colors import ColorTable
from vision_core.types.tables import TEAMS, Table

MAX_MISSING = 2
"""Missing patches that are explained, per robot."""


@dataclass(frozen=True, slots=True)
class Scene:
    """A frame to be explained. Its arrays have the types of the hot path's, so that no kernel is compiled anew."""

    seen: Observation
    """With the blobs of all color classes."""
    table: ColorTable
    robots: Callable[[RobotFinder], Table]
    """The robots that the hot path finds with a given finder: ROBOT table, shape (n,)."""

    @property
    def blobs(self) -> Table:
        """BLOB table, shape (n,)."""
        return self.seen.blobs


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
    finder.buffers.places[marker.team] = 0.0
    locate_blobs(scene.seen, marker, gates, finder.buffers)
    return finder.buffers.places[marker.team, blobs, 2] / marker.anchor_area_m2


def what_is_missing(scene: Scene, marker: Marker, hypothesis: Any, settings: Settings) -> str:
    """Which of a hypothesis' patches are missing, and what is seen in their places."""
    missing = [slot for slot in range(len(marker.slots_m)) if hypothesis["slot_blobs"][slot] < 0]
    pattern = pattern_name(settings, marker)
    found = f"{1 + int(hypothesis['matched'])} of the {1 + len(marker.slots_m)} patches of pattern {pattern} are found"
    if not missing:
        return found
    places = "; ".join(_what_is_at(scene, marker, hypothesis, slot, settings) for slot in missing[:MAX_MISSING])
    return f"{found}; {places}"


def _what_is_at(scene: Scene, marker: Marker, hypothesis: Any, slot: int, settings: Settings) -> str:
    """What is seen where a slot's patch should be."""
    c, s = math.cos(hypothesis["heading_rad"]), math.sin(hypothesis["heading_rad"])
    a, b = marker.slots_m[slot]
    x_m, y_m = hypothesis["x_m"] + c * a - s * b, hypothesis["y_m"] + s * a + c * b
    x, y = pixel_from_field(scene.seen.camera, x_m, y_m, marker.height_m)
    patch, wanted = f"the {_side(a, b)} patch", " or ".join(_colors_of(scene.table, marker, slot))
    off = np.hypot(scene.blobs["x_px"] - x, scene.blobs["y_px"] - y)
    scale2 = pixels_per_square_metre(scene.seen.camera, hypothesis["x_m"], hypothesis["y_m"], marker.height_m)
    if not (off <= settings.robots.dot_tolerance_m * math.sqrt(scale2)).any():
        return f"{patch} is missing: there is nothing {wanted} at ({x:.0f}, {y:.0f}) px"
    blob = int(np.argmin(off))
    color = int(scene.blobs["color"][blob])
    if marker.digits[slot, color] == NO_DIGIT:
        return f"{patch} is {scene.table.names[color]}, not {wanted}"
    ratio = float(scene.blobs["area_px"][blob] / scale2 / marker.areas_m2[slot])
    return f"{patch} has {ratio:.2g} times the expected area"


def _colors_of(table: ColorTable, marker: Marker, slot: int) -> list[str]:
    """The color classes that a slot's patch may have."""
    return [table.names[color] for color in np.flatnonzero(marker.digits[slot] != NO_DIGIT)]


def _side(x: float, y: float) -> str:
    """Where a place in robot space is, in words."""
    along = "front" if x > abs(y) / 3.0 else "back" if x < -abs(y) / 3.0 else ""
    across = "left" if y > abs(x) / 3.0 else "right" if y < -abs(x) / 3.0 else ""
    return " ".join(word for word in (along, across) if word) or "middle"


def code_of(scene: Scene, marker: Marker, hypothesis: Any) -> str:
    """The code that a hypothesis shows, as initials of its colors."""
    colors = [
        int(scene.blobs["color"][hypothesis["slot_blobs"][slot]])
        for slot in range(len(marker.slots_m))
        if marker.place_values[slot]
    ]
    return "".join(scene.table.names[color][0].upper() for color in colors)


def pattern_name(settings: Settings, marker: Marker) -> str:
    """Name of the pattern of a marker's team."""
    return robots_of(settings.robots, TEAMS[marker.team]).pattern


def pixel_of(scene: Scene, blob: int) -> str:
    """Where a blob is, in words."""
    return f"({scene.blobs['x_px'][blob]:.0f}, {scene.blobs['y_px'][blob]:.0f}) px"
