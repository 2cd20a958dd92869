"""What becomes of every blob of a team's color. Slow, and never on the hot path."""

import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from vision_core.models.camera_kernels import field_and_scale
from vision_core.objects.field_limits import is_accepted
from vision_core.objects.robots.finder import RobotFinder
from vision_core.objects.robots.markers import Marker
from vision_core.objects.robots.scene import (
    Scene,
    SeenRobots,
    hypotheses_of,
    pattern_name,
    seen_robots,
    what_is_missing,
)
from vision_core.objects.robots.unread import unread_because
from vision_core.objects.verdicts import size_words
from vision_core.settings.schema import Settings
from vision_core.types.overlay import Hypothesis
from vision_core.types.tables import NO_ID, TEAMS, Table

GATES = (
    "off the field (robots.margin_m)",
    "of the wrong size (robots.min_area, robots.max_area)",
    "without another patch of its marker",
    "below robots.min_confidence",
    "in the place of a better robot",
)
"""What is wrong with a blob that a gate stops, in the order of the gates."""
OFF_FIELD, WRONG_SIZE, ALONE, LOW_CONFIDENCE, PLACE_TAKEN, PASSED = range(6)


def robot_verdicts(scene: Scene, finder: RobotFinder, settings: Settings) -> Iterator[tuple[int, Hypothesis]]:
    """Of every blob of a team's color: how many gates it passed, and the verdict."""
    seen = seen_robots(scene, finder)
    robots, chosen, found = seen.robots, seen.hypotheses, seen.found
    verdicts: dict[tuple[int, int], tuple[int, Hypothesis]] = {}
    for marker in finder.markers:
        own = {int(row["anchor"]): k for k, row in enumerate(chosen) if row["marker"] == marker.number}
        best: dict[int, Any] = {}
        for row in hypotheses_of(scene, finder, marker):
            best.setdefault(int(row["anchor"]), row)
        for blob in np.flatnonzero(scene.blobs["color"] == marker.anchor_class).tolist():
            if (k := own.get(blob)) is None:
                verdict = _rejected(scene, finder, marker, blob, best.get(blob), robots, settings)
            else:
                verdict = PASSED, _accepted(scene, marker, chosen[k], found[k], seen, k, settings)
            # of a team's markers, the one with which the blob comes farthest
            passed, _ = verdicts.setdefault((marker.team, blob), verdict)
            if verdict[0] > passed:
                verdicts[marker.team, blob] = verdict
    yield from verdicts.values()


def _accepted(
    scene: Scene, marker: Marker, hypothesis: Any, robot: Any, seen: SeenRobots, k: int, settings: Settings
) -> Hypothesis:  # fmt: skip
    """The verdict on a robot, the k-th of those that are seen."""
    number, is_alike, why = seen.id_of(k), bool(seen.alike[k]), ""
    if number == NO_ID and (marker.has_code or is_alike):
        reason = unread_because(scene, marker, hypothesis, settings, is_alike=is_alike)
        why = reason.text if reason else "the marker of another robot of its team"
    return Hypothesis(
        what=_what(marker),
        id=None if number == NO_ID else number,
        is_accepted=True,
        x_px=float(robot["x_px"]),
        y_px=float(robot["y_px"]),
        radius_px=_radius_px(scene, marker, robot["x_px"], robot["y_px"]),
        box_px=_box(scene, int(hypothesis["anchor"])),
        confidence=float(robot["confidence"]),
        gate="without an id" if why else "",
        found=why,
        accepted=f"a marker of pattern {pattern_name(settings, marker)} that no other robot has" if why else "",
    )


def _rejected(
    scene: Scene, finder: RobotFinder, marker: Marker, blob: int, best: Any, robots: Table, settings: Settings
) -> tuple[int, Hypothesis]:  # fmt: skip
    """How many gates a blob passed, and which one stopped it. best: its best hypothesis, or None."""
    gate, found, accepted = _stop(scene, finder, marker, blob, best, robots, settings)
    x, y = float(scene.blobs["x_px"][blob]), float(scene.blobs["y_px"][blob])
    return gate, Hypothesis(
        what=_what(marker),
        id=None,
        is_accepted=False,
        x_px=x,
        y_px=y,
        radius_px=_radius_px(scene, marker, x, y),
        box_px=_box(scene, blob),
        confidence=None if best is None or gate < ALONE else float(best["score"]),
        gate=GATES[gate],
        found=found,
        accepted=accepted,
    )


def _stop(
    scene: Scene, finder: RobotFinder, marker: Marker, blob: int, best: Any, robots: Table, settings: Settings
) -> tuple[int, str, str]:  # fmt: skip
    """The gate that stopped a blob, what was found there, and what is accepted."""
    gates, row = finder.gates, scene.blobs[blob]
    x, y, scale2 = field_and_scale(scene.seen.camera, row["x_px"], row["y_px"], marker.height_m)
    if not is_accepted(x, y, marker.radius_m, gates.extents_m):
        far_x, far_y = (gates.extents_m[:2] + marker.radius_m).tolist()
        return OFF_FIELD, f"lies at ({x:.2f}, {y:.2f}) m", f"up to ±{far_x:.2f} m, ±{far_y:.2f} m, or in a goal"
    expected_px = marker.anchor_area_m2 * scale2
    if not gates.min_area <= row["area_px"] / expected_px <= gates.max_area:
        shares = (gates.min_area, gates.max_area)
        is_disc = bool(marker.radii_m[0] > 0.0)
        return WRONG_SIZE, *size_words(float(row["area_px"]), expected_px, shares, is_disc=is_disc)
    if best is None or best["score"] < gates.min_confidence:
        if best is None or best["matched"] == 0 < len(marker.slots_m):
            pattern, count = pattern_name(settings, marker), len(marker.slots_m)
            return ALONE, "no other patch near it", f"some of the {count} other patches of pattern {pattern}"
        missing = what_is_missing(scene, marker, best, settings)
        return LOW_CONFIDENCE, f"confidence {best['score']:.2f}: {missing}", f"{gates.min_confidence:g} or more"
    return PLACE_TAKEN, _rival_in_words(robots, best), "robots that share no patch and do not overlap"


def _rival_in_words(robots: Table, hypothesis: Any) -> str:
    """The robot that stands where a hypothesis would."""
    if not len(robots):
        return "another hypothesis was chosen"
    away = np.hypot(robots["x_m"] - hypothesis["x_m"], robots["y_m"] - hypothesis["y_m"])
    rival = robots[int(np.argmin(away))]
    place = f"({rival['x_px']:.0f}, {rival['y_px']:.0f}) px"
    better = f"confidence {rival['confidence']:.2f} instead of {hypothesis['score']:.2f}"
    return f"the {TEAMS[rival['team']]} robot at {place} has {better}"


def _what(marker: Marker) -> str:
    return f"{TEAMS[marker.team]} robot"


def _radius_px(scene: Scene, marker: Marker, x_px: float, y_px: float) -> float:
    _, _, scale2 = field_and_scale(scene.seen.camera, x_px, y_px, marker.height_m)
    return marker.radius_m * math.sqrt(scale2) if scale2 > 0.0 else 0.0


def _box(scene: Scene, blob: int) -> tuple[int, int, int, int]:
    row = scene.blobs[blob]
    return int(row["left"]), int(row["top"]), int(row["right"]), int(row["bottom"])
