"""Why robots are not found or not identified, for people. Slow, and never on the hot path."""

import contextlib
import math
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import msgspec
import numpy as np

from vision_core.errors import SettingsError
from vision_core.models.camera_kernels import pixel_from_field, pixels_per_square_metre
from vision_core.models.from_settings import robots_of
from vision_core.objects.observation import Observation
from vision_core.objects.robots.buffers import finder_buffers
from vision_core.objects.robots.finder import RobotFinder, gates_from, robot_finder
from vision_core.objects.robots.hypothesis_generation import generate_hypotheses, locate_blobs
from vision_core.objects.robots.markers import NO_DIGIT, Marker, marker_of
from vision_core.objects.robots.pose_refinement import id_of
from vision_core.patterns.loader import load_pattern, scaled
from vision_core.settings.schema import Settings, TeamRobotSettings
from vision_core.types.colors import ColorTable
from vision_core.types.reasons import Reason
from vision_core.types.tables import NO_ID, TEAMS, Table
from vision_core.venues.loader import config_folder

NUMERALS = {2: "two", 3: "three", 4: "four"}
SAME_ROBOT_RADII = 0.5
"""A hypothesis so near to a found robot's center, in radii of a robot, is that robot."""
SCALES = tuple(round(1.06**step, 2) for step in range(-12, 13) if step)
"""Factors of the marker's size that are tried when robots are not identified: half to double."""
MIN_GAIN_RATIO = 1.3
"""Another pattern is suggested when it explains the picture better by this factor."""
NO_ID_WEIGHT = 0.2
"""Of the confidence of a robot without an id, when patterns are compared."""
MAX_REASONS = 3
"""Robots without an id that are explained, per team."""
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


def explain_robots(scene: Scene, settings: Settings, is_over: Callable[[], bool] = lambda: False) -> list[Reason]:
    """Why there are no robots, or why some have no id; empty when every robot is identified.

    is_over: called before each attempt with another pattern or size of markers; True ends the attempts.
    """
    finder = robot_finder(settings, scene.table)
    robots = scene.robots(finder)
    reasons = []
    for marker in finder.markers:
        own = robots[robots["team"] == marker.team]
        if not len(robots):
            reasons.append(_why_no_robot(scene, finder, marker, settings))
        elif (own["id"] == NO_ID).any() or not len(own):
            reasons += _why_no_id(scene, finder, marker, own, settings)
    if not len(robots) or (robots["id"] == NO_ID).any():
        reasons += _better_pattern(scene, robots, settings, is_over)
    return reasons


def _why_no_robot(scene: Scene, finder: RobotFinder, marker: Marker, settings: Settings) -> Reason:
    """What comes nearest to a robot of a team, and why it is rejected."""
    name, gates = TEAMS[marker.team], finder.gates
    blobs = np.flatnonzero(scene.blobs["color"] == marker.anchor_class)
    if not len(blobs):
        none = f"no {name} robot: no blob of color class {name}"
        return Reason(none, f"Put a {name} robot on the field, or widen color class {name}.")
    ratios = _anchor_area_ratios(scene, finder, marker, blobs)
    accepted = (ratios >= gates.min_area) & (ratios <= gates.max_area)
    if not accepted.any():
        nearest = int(np.argmin(np.abs(np.log(np.maximum(ratios, 1e-9)))))
        return Reason(
            f"no {name} robot: {len(blobs)} {_plural(len(blobs), 'blob')} of color class {name}, but none of the right "
            f"size; the nearest, at {_pixel(scene, blobs[nearest])}, has {ratios[nearest]:.2g} times the expected area "
            f"(accepted: {gates.min_area:g} to {gates.max_area:g})",
            "Check robots.height_m, the camera's height and the pattern.",
        )
    best = _best_hypothesis(scene, finder, marker)
    if best is None or best["matched"] == 0 < len(marker.slots_m):
        count = int(accepted.sum())
        return Reason(
            f"no {name} robot: {count} {_plural(count, 'blob')} of color class {name} and of the right size, the first "
            f"at {_pixel(scene, blobs[accepted][0])}, without another patch of pattern {_pattern(settings, marker)} "
            "near",
            "Choose the pattern that the robots wear, or widen the classes of its patches.",
        )
    return Reason(
        f"no {name} robot: the best candidate, at {_pixel(scene, int(best['anchor']))}, has confidence "
        f"{best['score']:.2f}, below robots.min_confidence = {settings.robots.min_confidence:g}: "
        f"{_what_is_missing(scene, marker, best, settings)}",
        "Repair or clean the marker, or widen the class of the patch that is missing.",
    )


def _why_no_id(
    scene: Scene, finder: RobotFinder, marker: Marker, robots: Table, settings: Settings
) -> list[Reason]:  # fmt: skip
    """Why a team's robots have no id."""
    name, hypotheses = TEAMS[marker.team], _hypotheses(scene, finder, marker)
    reasons, shown = [], Counter[int]()
    for robot in robots:
        apart = np.hypot(hypotheses["x_m"] - robot["x_m"], hypotheses["y_m"] - robot["y_m"])
        near = hypotheses[apart < SAME_ROBOT_RADII * marker.radius_m]
        if robot["id"] != NO_ID or not len(near):
            continue
        best = near[0]
        place = f"the {name} robot at ({robot['x_px']:.0f}, {robot['y_px']:.0f}) px"
        if best["matched"] < len(marker.slots_m):
            missing = f"{place} has no id: {_what_is_missing(scene, marker, best, settings)}"
            advice = "Repair or clean its marker, or widen the class of the patch that is missing."
            reasons.append(Reason(missing, advice))
        elif (number := id_of(scene.blobs, marker, best)) == NO_ID:
            pattern = _pattern(settings, marker)
            code = f"{place} has the code {_code(scene, marker, best)}, which is no id of pattern {pattern}"
            reasons.append(Reason(code, f"Give it a marker of this pattern: `pslv patterns print {pattern}`."))
        else:
            shown[number] += 1
    twice = [
        Reason(
            f"{NUMERALS.get(count, count)} robots have the marker of {name} {number}, so none of them has an id",
            "Give each robot a marker of its own.",
        )
        for number, count in shown.items()
        if count > 1
    ]
    return reasons[:MAX_REASONS] + twice


def _better_pattern(scene: Scene, robots: Table, settings: Settings, is_over: Callable[[], bool]) -> list[Reason]:
    """The shipped pattern, or the size of the own one, that explains the picture best, if it is clearly better."""
    best, best_gain = None, MIN_GAIN_RATIO * _gain(robots)
    for reason, finder in (*_finders_of_other_patterns(scene, settings), *_finders_of_other_sizes(scene, settings)):
        if is_over():
            break
        found = scene.robots(finder)
        ids = int((found["id"] != NO_ID).sum())
        if ids and (gain := _gain(found)) > best_gain:
            text = f"{reason.text} {ids} {_plural(ids, 'robot')} would be identified"
            best, best_gain = Reason(text, reason.advice), gain
    return [best] if best else []


def _finders_of_other_patterns(scene: Scene, settings: Settings) -> Iterator[tuple[Reason, RobotFinder]]:
    """For every shipped pattern whose colors are classes of this venue: a finder, and its reason's first words."""
    own = {robots_of(settings.robots, team).pattern for team in TEAMS}
    for path in sorted((config_folder() / "patterns").glob("*.toml")):
        if path.stem in own:
            continue
        shape = load_pattern(path.stem).robot
        team = TeamRobotSettings(
            pattern=path.stem, outline=shape.outline, radius_m=shape.radius_m, height_m=shape.height_m
        )
        other = msgspec.structs.replace(settings.robots, blue=team, yellow=team)
        with contextlib.suppress(SettingsError):
            finder = robot_finder(msgspec.structs.replace(settings, robots=other), scene.table)
            text = f"another pattern? With robots.pattern = {path.stem!r}"
            yield Reason(text, f"Set robots.pattern = {path.stem!r} if the robots wear it."), finder


def _finders_of_other_sizes(scene: Scene, settings: Settings) -> Iterator[tuple[Reason, RobotFinder]]:
    """A finder for markers that look larger or smaller than they are, as a wrong camera height makes them."""
    buffers = finder_buffers(settings.blobs.max_blobs)
    for factor in SCALES:
        blue, yellow = (
            marker_of(
                scaled(load_pattern(robots.pattern), factor), robots, team, number, scene.table,
                settings.robots.dot_tolerance_m,
            )
            for number, team in enumerate(TEAMS)
            for robots in [robots_of(settings.robots, team)]
        )  # fmt: skip
        area = f"blobs have {factor**2:.1f} times the expected area"
        text = f"wrong camera height or field size? The {area}; with markers {factor:.2f} times as large"
        yield (
            Reason(text, "Measure the camera's height and the field again."),
            RobotFinder((blue, yellow), gates_from(settings), buffers),
        )


def _gain(robots: Table) -> float:
    """How well robots explain the picture: the sum of their confidences, less weight for those without an id."""
    return float((robots["confidence"] * np.where(robots["id"] != NO_ID, 1.0, NO_ID_WEIGHT)).sum())


def _hypotheses(scene: Scene, finder: RobotFinder, marker: Marker) -> Table:
    """All hypotheses of a team, however low their score, best first."""
    gates = finder.gates._replace(min_confidence=0.0)
    listed = locate_blobs(scene.seen, marker, gates, finder.buffers)
    count = generate_hypotheses(scene.seen, listed, marker, gates, finder.buffers, 0)
    rows: Table = finder.buffers.hypotheses[:count].copy()
    return rows[np.argsort(-rows["score"], kind="stable")]


def _best_hypothesis(scene: Scene, finder: RobotFinder, marker: Marker) -> Any:
    rows = _hypotheses(scene, finder, marker)
    return rows[0] if len(rows) else None


def _anchor_area_ratios(scene: Scene, finder: RobotFinder, marker: Marker, blobs: Any) -> Any:
    """Areas of blobs over the anchor's."""
    gates = finder.gates._replace(min_area=0.0)
    finder.buffers.places[marker.team] = 0.0
    locate_blobs(scene.seen, marker, gates, finder.buffers)
    return finder.buffers.places[marker.team, blobs, 2] / marker.anchor_area_m2


def _what_is_missing(scene: Scene, marker: Marker, hypothesis: Any, settings: Settings) -> str:
    """Which of a hypothesis' patches are missing, and what is seen in their places."""
    missing = [slot for slot in range(len(marker.slots_m)) if hypothesis["slot_blobs"][slot] < 0]
    pattern = _pattern(settings, marker)
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


def _code(scene: Scene, marker: Marker, hypothesis: Any) -> str:
    """The code that a hypothesis shows, as initials of its colors."""
    colors = [
        int(scene.blobs["color"][hypothesis["slot_blobs"][slot]])
        for slot in range(len(marker.slots_m))
        if marker.place_values[slot]
    ]
    return "".join(scene.table.names[color][0].upper() for color in colors)


def _pattern(settings: Settings, marker: Marker) -> str:
    return robots_of(settings.robots, TEAMS[marker.team]).pattern


def _pixel(scene: Scene, blob: int) -> str:
    return f"({scene.blobs['x_px'][blob]:.0f}, {scene.blobs['y_px'][blob]:.0f}) px"


def _plural(count: int, noun: str) -> str:
    return noun if count == 1 else f"{noun}s"
