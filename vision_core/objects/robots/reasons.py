"""Why robots are not found or not identified, for people. Slow, and never on the hot path.

``unread`` lists what is like a robot and is not read; ``alternatives`` and ``marker_size`` try what would explain all
of it at once.
"""

from collections import Counter
from collections.abc import Callable, Iterator

import numpy as np

from vision_core.objects.robots.alternatives import better_pattern, mirror_reason
from vision_core.objects.robots.finder import RobotFinder, robot_finder
from vision_core.objects.robots.marker_size import size_reason
from vision_core.objects.robots.markers import Marker, largest_tolerance_m, tells_heading
from vision_core.objects.robots.pose_refinement import id_of
from vision_core.objects.robots.scene import (
    Scene,
    SeenRobots,
    anchor_area_ratios,
    counted,
    pattern_name,
    pixel_of,
    seen_robots,
    what_is_missing,
)
from vision_core.objects.robots.unread import (
    NO_TEAM,
    REPAIR,
    Missed,
    missed_robots,
    places_in_words,
    unread_because,
)
from vision_core.settings.schema import Settings
from vision_core.types.reasons import Reason
from vision_core.types.tables import TEAMS

NUMERALS = {2: "two", 3: "three", 4: "four"}
MAX_REASONS = 3
"""Robots of a kind that are explained one by one; of the others the places are said."""
MAX_PLACES = 12
"""Places that are listed in one reason."""


def explain_robots(
    scene: Scene, settings: Settings, is_over: Callable[[], bool] = lambda: False, *, is_floor_right: bool = False
) -> list[Reason]:
    """Why there are no robots, why some are not found, and why some have no id or no heading.

    Empty when every robot is read and as large as it should be. is_over: called before each attempt with another
    pattern or size of markers; True ends the attempts. is_floor_right: as of ``doubts_of``.
    """
    finder = robot_finder(settings, scene.table)
    seen = seen_robots(scene, finder)
    missed = missed_robots(scene, finder, settings, seen)
    reasons = list(_not_found(missed, seen, settings))
    for marker in finder.markers:
        is_first = marker is next(one for one in finder.markers if one.team == marker.team)
        if is_first and not len(seen.known) and not any(one.team in (marker.team, NO_TEAM) for one in missed):
            reasons.append(_why_no_robot(scene, finder, marker))
        reasons += _without_heading(scene, marker, seen, settings)
        reasons += _why_no_id(scene, marker, seen, settings)
    if len(seen.robots) and not is_over():
        reasons += _doubts(scene, finder, seen, settings, is_floor_right=is_floor_right)
    if missed or not len(seen.known) or any(map(seen.lacks_id, range(len(seen.found)))):
        reasons += better_pattern(scene, seen.robots, settings, is_over)
    return reasons


def doubts_of(scene: Scene, settings: Settings, *, is_floor_right: bool) -> list[Reason]:
    """What robots that are read say against a calibration: a wrong height of the camera, a mirrored picture.

    is_floor_right: places on the floor are right, by named points or lines, whatever the camera's height is.
    """
    finder = robot_finder(settings, scene.table)
    return list(_doubts(scene, finder, seen_robots(scene, finder), settings, is_floor_right=is_floor_right))


def _doubts(
    scene: Scene, finder: RobotFinder, seen: SeenRobots, settings: Settings, *, is_floor_right: bool
) -> Iterator[Reason]:  # fmt: skip
    is_floor_right = is_floor_right or settings.camera.model == "homography"
    height_m = float(scene.seen.camera.position_m[2])
    if size := size_reason(scene, finder.markers, seen, height_m, is_floor_right=is_floor_right):
        yield size
    if mirror := mirror_reason(scene, seen.robots, settings):
        yield mirror


def _not_found(missed: list[Missed], seen: SeenRobots, settings: Settings) -> Iterator[Reason]:
    """What is like a robot and is not found: each with its place."""
    for team in sorted({one.team for one in missed}):
        own = [one for one in missed if one.team == team]
        name = "robot" if team == NO_TEAM else f"{TEAMS[team]} robot"
        lone = [one for one in own if one.is_alone]
        lacking = settings.match.numbers - int((seen.known["team"] == team).sum())
        if len(lone) > max(lacking, MAX_REASONS):
            own = [one for one in own if not one.is_alone]
            yield _markings(lone, name, lacking)
        for one in own[:MAX_REASONS]:
            yield Reason(f"a {name} at ({one.x_px:.0f}, {one.y_px:.0f}) px is not found: {one.why}", one.advice, 1.0)
        if further := own[MAX_REASONS:]:
            places = [(one.x_px, one.y_px) for one in further]
            yield from _further(places, name, "not found", further[0].advice)


def _markings(lone: list[Missed], name: str, lacking: int) -> Reason:
    """More patches of a team's color alone than the match has robots: perhaps none of them is one."""
    places = places_in_words(np.array([(one.x_px, one.y_px) for one in lone]), MAX_PLACES)
    what = f"{len(lone)} patches of a {name}'s color and size are without another patch near, at {places}"
    text = f"{what}: robots whose other patches are not seen, or markings of the field"
    return Reason(text, f"{lone[0].advice} Mask markings that have a team's color.", float(max(lacking, 0)))


def _further(places: list[tuple[float, float]], name: str, what: str, advice: str) -> Iterator[Reason]:
    """The places of those that are not explained one by one."""
    if places:
        count = len(places)
        where = places_in_words(np.array(places), MAX_PLACES)
        text = f"{counted(count, f'more {name}')} {'is' if count == 1 else 'are'} {what}, at {where}"
        yield Reason(text, advice, float(count))


def _without_heading(scene: Scene, marker: Marker, seen: SeenRobots, settings: Settings) -> Iterator[Reason]:
    """Robots whose heading is not known although all their patches are seen, or whose pattern has no code."""
    name, tolerance_m, blind = TEAMS[marker.team], settings.robots.dot_tolerance_m, []
    for robot, hypothesis, is_read in zip(seen.found, seen.hypotheses, seen.read, strict=True):
        if is_read or hypothesis["marker"] != marker.number or not np.isnan(robot["heading_rad"]):
            continue
        if hypothesis["matched"] == len(marker.slots_m):
            blind.append((float(robot["x_px"]), float(robot["y_px"])))
        elif not marker.has_code:
            missing = what_is_missing(scene, marker, hypothesis, settings)
            place = f"the {name} robot at ({robot['x_px']:.0f}, {robot['y_px']:.0f}) px"
            yield Reason(f"the heading of {place} is not known: {missing}", REPAIR, 1.0)
    if not blind:
        return
    what = f"the heading of {counted(len(blind), f'{name} robot')} is ambiguous"
    where = f"at {places_in_words(np.array(blind), MAX_PLACES)}"
    if tells_heading(marker):
        why = "another heading explains its patches as well"
        yield Reason(f"{what}, {where}: {why}", REPAIR, float(len(blind)))
        return
    pattern = pattern_name(settings, marker)
    why = (
        f"turned, pattern {pattern} looks like itself when patches may lie {1e3 * tolerance_m:g} mm beside their places"
    )
    advice = "Give the robots a pattern that looks the same in no other heading."
    if enough_m := largest_tolerance_m(marker, tolerance_m):
        advice = f"Set robots.dot_tolerance_m = {enough_m:g} or less, or draw the pattern less symmetric."
    yield Reason(f"{what}, {where}: {why}", advice, float(len(blind)))


def _why_no_robot(scene: Scene, finder: RobotFinder, marker: Marker) -> Reason:
    """Why nothing of a team is seen at all: no blob of its color, or none of the right size."""
    name, color, gates = TEAMS[marker.team], scene.table.names[marker.anchor_class], finder.gates
    blobs = np.flatnonzero(scene.blobs["color"] == marker.anchor_class)
    if not len(blobs):
        none = f"no {name} robot: no blob of color class {color}"
        return Reason(none, f"Put a {name} robot on the field, or widen color class {color}.")
    ratios = anchor_area_ratios(scene, finder, marker, blobs)
    if not (on_field := ratios > 0.0).any():
        off = f"no {name} robot: all {counted(len(blobs), 'blob')} of color class {color} lie off the field"
        where = f"the first at {pixel_of(scene, int(blobs[0]))}"
        return Reason(f"{off}, {where}", "Put a robot on the field, or check the calibration and the field's measures.")
    blobs, ratios = blobs[on_field], ratios[on_field]
    nearest = int(np.argmin(np.abs(np.log(ratios))))
    return Reason(
        f"no {name} robot: {counted(len(blobs), 'blob')} of color class {color}, but none of the right "
        f"size; the nearest, at {pixel_of(scene, int(blobs[nearest]))}, has {ratios[nearest]:.2g} times the expected "
        f"area (accepted: {gates.min_area:g} to {gates.max_area:g})",
        "Check robots.height_m, the camera's height and the pattern.",
    )


def _why_no_id(scene: Scene, marker: Marker, seen: SeenRobots, settings: Settings) -> Iterator[Reason]:
    """Why a team's robots have no id."""
    name = TEAMS[marker.team]
    shown, twins, said, further = Counter[int](), [], 0, []
    for number, robot in enumerate(seen.found):
        hypothesis = seen.hypotheses[number]
        if hypothesis["marker"] != marker.number or not seen.lacks_id(number):
            continue
        place = (float(robot["x_px"]), float(robot["y_px"]))
        if np.isnan(robot["heading_rad"]) and hypothesis["matched"] == len(marker.slots_m):
            continue  # its heading is ambiguous, and said to be
        is_alike = bool(seen.alike[number])
        is_read = not marker.has_code and not is_alike
        why = None if is_read else unread_because(scene, marker, hypothesis, settings, is_alike=is_alike)
        if why is None:
            shown[id_of(scene.blobs, marker, hypothesis)] += 1
            twins.append((id_of(scene.blobs, marker, hypothesis), place))
        elif (said := said + 1) <= MAX_REASONS:
            text = f"the {name} robot at ({place[0]:.0f}, {place[1]:.0f}) px has {why.text}"
            yield Reason(text, why.advice, 1.0)
        else:
            further.append(place)
    yield from _further(further, f"{name} robot", "without an id", "Repair their markers, or widen the color classes.")
    for number, count in shown.items():
        where = places_in_words(np.array([place for one, place in twins if one == number]), MAX_PLACES)
        if count > 1 and not marker.has_code:
            pattern = pattern_name(settings, marker)
            text = f"{count} {name} robots wear pattern {pattern}, which has no code, so none of them has an id"
            yield Reason(f"{text}: at {where}", "Let them wear a pattern with a code.", float(count))
        elif count > 1:
            text = f"{NUMERALS.get(count, count)} robots have the marker of {name} {number}, so none of them has an id"
            yield Reason(f"{text}: at {where}", "Give each robot a marker of its own.", float(count))
        else:
            yield Reason(
                f"the blobs of the {name} robot at {where} show id {number}, but patches of its code are overexposed: "
                "in two of three channels they are saturated, and other ids look the same",
                "Close the lens, or lower the camera's exposure or gain.",
                1.0,
            )
