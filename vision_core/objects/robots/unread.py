"""Robot-like things that are not read: every one with its place and with what is wrong about it. Slow, for people.

Three searches, each for what the one before left: a finder with wider gates (patches of a wrong size or beside their
places, robots off the field), patches of a team's color alone, and patches of a marker without one of a team.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from vision_core.geometry import Floats, frozen
from vision_core.models.camera_kernels import pixel_from_field, pixels_per_square_metre
from vision_core.models.from_settings import robots_of
from vision_core.objects.field_limits import accepted_extents, is_accepted
from vision_core.objects.robots.finder import RobotFinder
from vision_core.objects.robots.headless import Headless, headless_markers
from vision_core.objects.robots.hypothesis_generation import locate_blobs, slot_area_ratio
from vision_core.objects.robots.markers import Marker
from vision_core.objects.robots.pose_refinement import id_of
from vision_core.objects.robots.scene import (
    APART,
    Scene,
    SeenRobots,
    code_of,
    hypotheses_of,
    merged_into,
    missing_slots,
    pattern_name,
    place_of_slot,
    seen_robots,
    shape_names,
    shaped_slots,
    side_of,
    what_is_missing,
)
from vision_core.objects.robots.shape_reading import MAX_MISFIT, MIN_MARGIN, is_shape_sure
from vision_core.settings.schema import Settings
from vision_core.types.reasons import Reason
from vision_core.types.tables import NO_ID, TEAMS

WIDER_AREA, WIDER_TOLERANCE, WIDER_FIELD = 8.0, 1.6, 3.0
"""Factors of the gates within which something is robot-like."""
MIN_LIKENESS = 0.15
MIN_PATCHES = 2
"""Patches beside the team's that make something robot-like; fewer where the pattern has fewer."""
SURE_PATCHES = 3
"""So many patches beside the team's, or without one, are no chance."""
LINE_RADII = 0.5
"""A robot stands so many radii inside the walls or limits."""
MAX_ELONGATION = 1.8
"""Of a lone patch's box, as a multiple of the drawn patch's: a stripe along a wall is no patch."""
NO_TEAM = -1
WRONG_SIZE = "Give it a patch of the right size, or correct robots.height_m, the camera's height and the pattern."
MISPLACED = "Check the pattern's measures and the calibration, or widen robots.dot_tolerance_m."
OFF_FIELD = "Check the calibration and the field's measures, or widen robots.margin_m."
SEPARATE = "Give it an id whose neighboring patches differ in color, or wider gaps: see `pslv patterns check --venue`."
REPAIR = "Repair or clean its marker, or widen the class of the patch that is missing."


@dataclass(frozen=True, slots=True)
class Missed:
    """Something like a robot that is not found."""

    team: int
    """Number of its team, or NO_TEAM."""
    x_px: float
    y_px: float
    why: str
    """After "is not found: "."""
    advice: str
    is_alone: bool = False
    """Only its team's patch is seen."""


def unread_because(
    scene: Scene, marker: Marker, hypothesis: Any, settings: Settings, *, is_alike: bool
) -> Reason | None:  # fmt: skip
    """What a hypothesis has in place of an id; None when it has one.

    is_alike: another marker of the same team explains the robot about as well.
    """
    if is_alike:
        names = " or ".join(robots_of(settings.robots, TEAMS[marker.team]).patterns)
        text = f"no id: pattern {names}? They explain about as many pixels of it"
        return Reason(text, "Let the robots of a team wear patterns that differ more.")
    if hypothesis["matched"] < len(marker.slots_m):
        missing = f"no id: {what_is_missing(scene, marker, hypothesis, settings)}"
        return Reason(missing, _repair(scene, marker, hypothesis, settings))
    if id_of(scene.blobs, marker, hypothesis) == NO_ID:
        pattern = pattern_name(settings, marker)
        if unclear := _unclear_shape(scene, marker, hypothesis, settings):
            return unclear
        code = f"the code {code_of(scene, marker, hypothesis, settings)}, which is no id of pattern {pattern}"
        return Reason(code, f"Give it a marker of this pattern: `pslv patterns print {pattern}`.")
    return None


def _repair(scene: Scene, marker: Marker, hypothesis: Any, settings: Settings) -> str:
    """What to do about a robot with missing patches."""
    slots = missing_slots(marker, hypothesis)
    if any(merged_into(scene, marker, hypothesis, slot, settings) for slot in slots):
        return SEPARATE
    return REPAIR


def _unclear_shape(scene: Scene, marker: Marker, hypothesis: Any, settings: Settings) -> Reason | None:
    """That one of a hypothesis' patches has no clear shape; None when all have."""
    for slot in shaped_slots(settings, marker):
        if is_shape_sure(hypothesis, slot):
            continue
        names, place = shape_names(settings, marker), f"the shape of its {side_of(*marker.slots_m[slot])} patch"
        best, rival = (names[hypothesis[key][slot]] for key in ("shapes", "rival_shapes"))
        if hypothesis["shape_misfits"][slot] > MAX_MISFIT:
            text = f"no id: {place} is none of {', '.join(names)}; it is most like {best}"
            return Reason(text, "Repair its marker, take away what lies on it, or correct the pattern.")
        scale2 = pixels_per_square_metre(scene.seen.camera, hypothesis["x_m"], hypothesis["y_m"], marker.height_m)
        margin = f"by {hypothesis['shape_margins'][slot]:.0f} of {MIN_MARGIN:g}"
        text = f"no id: {place} may be {best} or {rival} ({margin}, at {1e3 / math.sqrt(scale2):.2g} mm per pixel)"
        return Reason(text, "Cut shapes that differ more, or larger ones, or bring the camera nearer.")
    return None


def missed_robots(scene: Scene, finder: RobotFinder, settings: Settings, seen: SeenRobots) -> list[Missed]:
    """Everything like a robot that is neither found nor read, each once; seen: what the finder finds.

    Markings of the field, goals and noise may look like one or two patches. So few count only while a team has fewer
    robots than the match gives it.
    """
    places = [(float(row["x_m"]), float(row["y_m"])) for row in seen.known]
    lacks = [(seen.known["team"] == team).sum() < settings.match.numbers for team in range(len(TEAMS))]
    missed = []
    for marker, hypothesis in _robot_like(scene, finder):
        is_likely = lacks[marker.team] or hypothesis["matched"] >= SURE_PATCHES
        if is_likely and not _is_among(places, hypothesis["x_m"], hypothesis["y_m"], marker):
            missed.append(_missed(scene, finder, marker, hypothesis, settings))
            places.append((float(hypothesis["x_m"]), float(hypothesis["y_m"])))
    for marker in finder.markers:
        for blob, (x_m, y_m) in _lone_anchors(scene, finder, marker, settings) if lacks[marker.team] else ():
            if not _is_among(places, x_m, y_m, marker):
                missed.append(_alone(scene, finder, marker, blob, settings))
                places.append((x_m, y_m))
    for marker in _different(finder.markers):
        for found in headless_markers(scene, finder, marker, np.array(places).reshape(-1, 2)):
            if any(lacks) or found.patches >= SURE_PATCHES:
                missed.append(_headless(scene, marker, found, settings))
                places.append(found.center_m)
    return missed


def _headless(scene: Scene, marker: Marker, found: Headless, settings: Settings) -> Missed:
    x, y = pixel_from_field(scene.seen.camera, *found.center_m, marker.height_m)
    name = pattern_name(settings, marker)
    why = f"patches of pattern {name} are there, but none of a team: {found.in_place_of_team}"
    return Missed(NO_TEAM, x, y, why, "Give it a patch of its team's color, or widen the class of that color.")


def _different(markers: tuple[Marker, ...]) -> Iterator[Marker]:
    """The markers of teams without those that have the patches of another team."""
    known: list[Marker] = []
    for marker in markers:
        if not any(
            np.array_equal(marker.slots_m, one.slots_m) and np.array_equal(marker.digits, one.digits) for one in known
        ):
            known.append(marker)
            yield marker


def _is_among(places: list[tuple[float, float]], x_m: float, y_m: float, marker: Marker) -> bool:
    return any(math.hypot(x_m - x, y_m - y) < APART * marker.radius_m for x, y in places)


def _robot_like(scene: Scene, finder: RobotFinder) -> Iterator[tuple[Marker, Any]]:
    """What a finder with wider gates takes for robots, with at least some patches beside the team's."""
    gates = finder.gates
    wider = gates._replace(
        min_area=gates.min_area / WIDER_AREA,
        max_area=gates.max_area * WIDER_AREA,
        tolerance_m=gates.tolerance_m * WIDER_TOLERANCE,
        min_confidence=min(MIN_LIKENESS, gates.min_confidence),
        extents_m=frozen(gates.extents_m * WIDER_FIELD),
    )
    for hypothesis in seen_robots(scene, finder._replace(gates=wider)).hypotheses:
        marker = finder.markers[hypothesis["marker"]]
        if hypothesis["matched"] >= max(min(MIN_PATCHES, len(marker.slots_m)), 1):
            yield marker, hypothesis


def _missed(scene: Scene, finder: RobotFinder, marker: Marker, hypothesis: Any, settings: Settings) -> Missed:
    """Why a robot-like thing is not found: the first gate that stops it."""
    x_m, y_m = float(hypothesis["x_m"]), float(hypothesis["y_m"])
    x, y = pixel_from_field(scene.seen.camera, x_m, y_m, marker.height_m)
    why, advice = _stopped_by(scene, finder, marker, hypothesis, settings)
    return Missed(marker.team, x, y, why, advice)


def _stopped_by(
    scene: Scene, finder: RobotFinder, marker: Marker, hypothesis: Any, settings: Settings
) -> tuple[str, str]:  # fmt: skip
    gates, x_m, y_m = finder.gates, float(hypothesis["x_m"]), float(hypothesis["y_m"])
    if not is_accepted(x_m, y_m, marker.radius_m, gates.extents_m):
        far_x, far_y = (gates.extents_m[:2] + marker.radius_m).tolist()
        where = f"it lies off the field, at ({x_m:.2f}, {y_m:.2f}) m (accepted: up to ±{far_x:.2f} m, ±{far_y:.2f} m)"
        return where, OFF_FIELD
    if size := _wrong_size(scene, finder, marker, hypothesis):
        return size, WRONG_SIZE
    off_m = max(_patch_offsets_m(scene, marker, hypothesis), default=0.0)
    if off_m > gates.tolerance_m:
        found = f"its patches lie up to {1e3 * off_m:.0f} mm beside their places in the marker"
        return f"{found} (accepted: robots.dot_tolerance_m = {1e3 * gates.tolerance_m:.0f} mm)", MISPLACED
    own = hypotheses_of(scene, finder, marker)
    rows = own[own["anchor"] == hypothesis["anchor"]]
    best = rows[0] if len(rows) else hypothesis
    if best["score"] >= gates.min_confidence:
        return "it overlaps a better robot, or shares a patch with it", "Set the robots farther apart."
    missing = what_is_missing(scene, marker, best, settings)
    found = f"its confidence is {best['score']:.2f}, below robots.min_confidence = {gates.min_confidence:g}: {missing}"
    return found, _repair(scene, marker, best, settings)


def _wrong_size(scene: Scene, finder: RobotFinder, marker: Marker, hypothesis: Any) -> str:
    """Which of its patches has not the right size; empty when all have."""
    gates = finder.gates
    scale2 = pixels_per_square_metre(scene.seen.camera, hypothesis["x_m"], hypothesis["y_m"], marker.height_m)
    for patch in range(1 + len(marker.slots_m)):
        blob = int(hypothesis["anchor"] if patch == 0 else hypothesis["slot_blobs"][patch - 1])
        area_m2 = float(scene.blobs["area_px"][blob] / scale2)
        ratio = area_m2 / marker.anchor_area_m2 if patch == 0 else slot_area_ratio(marker.areas_m2, patch - 1, area_m2)
        ratio = ratio if blob >= 0 else 1.0
        if not gates.min_area <= ratio <= gates.max_area:
            place = marker.anchor_m if patch == 0 else marker.slots_m[patch - 1]
            size = f"has {ratio:.2g} times the expected area"
            if (diameter_mm := 2e3 * float(marker.radii_m[patch])) > 0.0:
                size = f"is {math.sqrt(ratio) * diameter_mm:.0f} mm across, not {diameter_mm:.0f} mm"
            accepted = f"accepted: {gates.min_area:g} to {gates.max_area:g} times the area"
            return f"its {side_of(*place.tolist())} patch {size} ({accepted})"
    return ""


def _patch_offsets_m(scene: Scene, marker: Marker, hypothesis: Any) -> Iterator[float]:
    """How far its patches lie beside their places, each [m]."""
    scale = math.sqrt(pixels_per_square_metre(scene.seen.camera, hypothesis["x_m"], hypothesis["y_m"], marker.height_m))
    for slot in range(len(marker.slots_m)):
        if (blob := int(hypothesis["slot_blobs"][slot])) >= 0:
            x, y = place_of_slot(scene, marker, hypothesis, slot)
            yield math.hypot(scene.blobs["x_px"][blob] - x, scene.blobs["y_px"][blob] - y) / scale


def _lone_anchors(
    scene: Scene, finder: RobotFinder, marker: Marker, settings: Settings
) -> Iterator[tuple[int, tuple[float, float]]]:  # fmt: skip
    """Patches of a team's color that are inside the field and of the right size, with their places [m].

    Beside the field lie things of every color.
    """
    gates, buffers = finder.gates, finder.buffers
    inside = accepted_extents(settings.field, 0.0)
    count = locate_blobs(scene.seen, marker, gates, buffers)
    for blob in buffers.listed[:count].tolist():
        x_m, y_m, area_m2 = buffers.places[marker.number, blob].tolist()
        is_right_size = gates.min_area <= area_m2 / marker.anchor_area_m2 <= gates.max_area
        is_inside = is_accepted(x_m, y_m, -LINE_RADII * marker.radius_m, inside)
        box = scene.blobs[blob]
        sides = sorted((int(box["right"] - box["left"]) + 1, int(box["bottom"] - box["top"]) + 1))
        drawn = math.sqrt(marker.shape.variances_m2[0] / marker.shape.variances_m2[1])
        is_compact = sides[1] <= MAX_ELONGATION * drawn * sides[0]
        if box["color"] == marker.anchor_class and is_right_size and is_inside and is_compact:
            yield blob, (x_m, y_m)


def _alone(scene: Scene, finder: RobotFinder, marker: Marker, blob: int, settings: Settings) -> Missed:
    x, y = float(scene.blobs["x_px"][blob]), float(scene.blobs["y_px"][blob])
    own = hypotheses_of(scene, finder, marker)
    rows = own[(own["anchor"] == blob) & (own["matched"] > 0)]
    if len(rows):
        missing = what_is_missing(scene, marker, rows[0], settings)
        score, least = rows[0]["score"], finder.gates.min_confidence
        why = f"its confidence is {score:.2f}, below robots.min_confidence = {least:g}: {missing}"
        return Missed(marker.team, x, y, why, _repair(scene, marker, rows[0], settings))
    name = pattern_name(settings, marker)
    why = f"its team's patch is there, without another patch of pattern {name} near"
    advice = "Choose the pattern that the robots wear, or widen the classes of its patches."
    return Missed(marker.team, x, y, why, advice, is_alone=True)


def places_in_words(places: Floats, most: int) -> str:
    """Places in the picture, shape (n, 2) [px]: the first ones, and how many more there are."""
    shown = ", ".join(f"({x:.0f}, {y:.0f})" for x, y in places[:most].tolist())
    more = f" and {len(places) - most} more" if len(places) > most else ""
    return f"{shown} px{more}"
