"""Why robots are not found or not identified, for people. Slow, and never on the hot path."""

import contextlib
from collections import Counter
from collections.abc import Callable, Iterator
from typing import Any

import msgspec
import numpy as np

from vision_core.errors import SettingsError
from vision_core.models.from_settings import robots_of
from vision_core.objects.robots.buffers import finder_buffers
from vision_core.objects.robots.finder import RobotFinder, gates_from, robot_finder
from vision_core.objects.robots.markers import Marker, marker_of
from vision_core.objects.robots.pose_refinement import id_of
from vision_core.objects.robots.scene import (
    Scene,
    anchor_area_ratios,
    code_of,
    hypotheses_of,
    pattern_name,
    pixel_of,
    what_is_missing,
)
from vision_core.patterns.loader import load_pattern, scaled
from vision_core.settings.schema import Settings, TeamRobotSettings
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
    ratios = anchor_area_ratios(scene, finder, marker, blobs)
    accepted = (ratios >= gates.min_area) & (ratios <= gates.max_area)
    if not accepted.any():
        nearest = int(np.argmin(np.abs(np.log(np.maximum(ratios, 1e-9)))))
        return Reason(
            f"no {name} robot: {len(blobs)} {_plural(len(blobs), 'blob')} of color class {name}, but none of the right "
            f"size; the nearest, at {pixel_of(scene, blobs[nearest])}, has {ratios[nearest]:.2g} times the expected "
            f"area (accepted: {gates.min_area:g} to {gates.max_area:g})",
            "Check robots.height_m, the camera's height and the pattern.",
        )
    best = _best_hypothesis(scene, finder, marker)
    if best is None or best["matched"] == 0 < len(marker.slots_m):
        count = int(accepted.sum())
        return Reason(
            f"no {name} robot: {count} {_plural(count, 'blob')} of color class {name} and of the right size, the first "
            f"at {pixel_of(scene, blobs[accepted][0])}, without another patch of pattern "
            f"{pattern_name(settings, marker)} near",
            "Choose the pattern that the robots wear, or widen the classes of its patches.",
        )
    return Reason(
        f"no {name} robot: the best candidate, at {pixel_of(scene, int(best['anchor']))}, has confidence "
        f"{best['score']:.2f}, below robots.min_confidence = {settings.robots.min_confidence:g}: "
        f"{what_is_missing(scene, marker, best, settings)}",
        "Repair or clean the marker, or widen the class of the patch that is missing.",
    )


def _why_no_id(
    scene: Scene, finder: RobotFinder, marker: Marker, robots: Table, settings: Settings
) -> list[Reason]:  # fmt: skip
    """Why a team's robots have no id."""
    name, hypotheses = TEAMS[marker.team], hypotheses_of(scene, finder, marker)
    reasons, shown = [], Counter[int]()
    for robot in robots:
        apart = np.hypot(hypotheses["x_m"] - robot["x_m"], hypotheses["y_m"] - robot["y_m"])
        near = hypotheses[apart < SAME_ROBOT_RADII * marker.radius_m]
        if robot["id"] != NO_ID or not len(near):
            continue
        best = near[0]
        place = f"the {name} robot at ({robot['x_px']:.0f}, {robot['y_px']:.0f}) px"
        if why := unread_because(scene, marker, best, settings):
            reasons.append(Reason(f"{place} has {why.text}", why.advice))
        else:
            shown[id_of(scene.blobs, marker, best)] += 1
    twice = [
        Reason(
            f"{NUMERALS.get(count, count)} robots have the marker of {name} {number}, so none of them has an id",
            "Give each robot a marker of its own.",
        )
        for number, count in shown.items()
        if count > 1
    ]
    bright = [
        Reason(
            f"the blobs of a {name} robot show id {number}, but patches of its code are overexposed: in two of three "
            "channels they are saturated, and other ids look the same",
            "Close the lens, or lower the camera's exposure or gain.",
        )
        for number, count in shown.items()
        if count == 1
    ]
    return reasons[:MAX_REASONS] + twice + bright


def unread_because(scene: Scene, marker: Marker, hypothesis: Any, settings: Settings) -> Reason | None:
    """What a hypothesis has in place of an id; None when it has one."""
    if hypothesis["matched"] < len(marker.slots_m):
        missing = f"no id: {what_is_missing(scene, marker, hypothesis, settings)}"
        return Reason(missing, "Repair or clean its marker, or widen the class of the patch that is missing.")
    if id_of(scene.blobs, marker, hypothesis) == NO_ID:
        pattern = pattern_name(settings, marker)
        code = f"the code {code_of(scene, marker, hypothesis)}, which is no id of pattern {pattern}"
        return Reason(code, f"Give it a marker of this pattern: `pslv patterns print {pattern}`.")
    return None


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


def _best_hypothesis(scene: Scene, finder: RobotFinder, marker: Marker) -> Any:
    rows = hypotheses_of(scene, finder, marker)
    return rows[0] if len(rows) else None


def _plural(count: int, noun: str) -> str:
    return noun if count == 1 else f"{noun}s"
