"""Markers without a patch of a team: their other patches lie as in the pattern, and no blob of a team is among them."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import combinations, permutations

import numpy as np

from vision_core.geometry import Floats, rotation
from vision_core.models.camera_kernels import pixel_from_field
from vision_core.objects.robots.finder import RobotFinder
from vision_core.objects.robots.hypothesis_generation import area_score, locate_blobs, slot_area_ratio
from vision_core.objects.robots.markers import NO_DIGIT, SLOT_ROLE, Marker
from vision_core.objects.robots.scene import Scene, side_of
from vision_core.types.tables import TEAMS

MIN_PATCHES = 3
"""Patches that must lie as in the pattern; two where it has no more, and never fewer."""
MAX_PATCHES = 60
"""Patches that belong to no robot and are looked at."""


@dataclass(frozen=True, slots=True)
class Headless:
    """A marker without a patch of a team."""

    center_m: tuple[float, float]
    patches: int
    """How many of its other patches are there."""
    in_place_of_team: str
    """What is seen where the team's patch should be."""


def headless_markers(scene: Scene, finder: RobotFinder, marker: Marker, taken_m: Floats) -> Iterator[Headless]:
    """Every marker without a patch of a team.

    taken_m: places of robots, of which no patch is considered, shape (n, 2).
    """
    if len(marker.slots_m) < 2:
        return
    places, fits = _free_patches(scene, finder, marker, taken_m)
    while (found := _best_pose(places, fits, marker, finder.gates.tolerance_m)) is not None:
        center, heading_rad, used = found
        x_m, y_m = center.tolist()
        yield Headless((x_m, y_m), len(used), _in_place_of_team(scene, marker, center, heading_rad))
        far = np.hypot(*(places - center).T) > marker.radius_m
        far[used] = False
        places, fits = places[far], fits[far]


def _free_patches(
    scene: Scene, finder: RobotFinder, marker: Marker, taken_m: Floats
) -> tuple[Floats, np.ndarray]:  # fmt: skip
    """Places of the patches that belong to no robot, shape (n, 2) [m], and which slots each may fill, (n, slots)."""
    gates, buffers = finder.gates, finder.buffers
    count = locate_blobs(scene.seen, marker, gates, buffers)
    places, fits = [], []
    for blob in buffers.listed[:count].tolist():
        color = int(scene.blobs["color"][blob])
        x_m, y_m, area_m2 = buffers.places[marker.number, blob].tolist()
        is_near = len(taken_m) and np.hypot(*(taken_m - (x_m, y_m)).T).min() <= marker.radius_m
        if is_near or not marker.color_roles[color] & SLOT_ROLE:
            continue
        slots = [
            marker.digits[slot, color] != NO_DIGIT
            and area_score(slot_area_ratio(marker.areas_m2, slot, area_m2), gates) > 0.0
            for slot in range(len(marker.slots_m))
        ]
        if any(slots):
            places.append((x_m, y_m))
            fits.append(slots)
    shape = (-1, len(marker.slots_m))
    return np.array(places[:MAX_PATCHES]).reshape(-1, 2), np.array(fits[:MAX_PATCHES], dtype=np.bool_).reshape(shape)


def _best_pose(
    places: Floats, fits: np.ndarray, marker: Marker, tolerance_m: float
) -> tuple[Floats, float, list[int]] | None:  # fmt: skip
    """Center, heading and patches of the marker that most patches show; None where too few lie as in the pattern."""
    slots = marker.slots_m
    best, most = None, min(MIN_PATCHES, len(slots)) - 1
    for i, j in combinations(range(len(places)), 2):
        arm = places[j] - places[i]
        length = math.hypot(*arm)
        if length > 2.0 * marker.radius_m:
            continue
        for a, b in permutations(range(len(slots)), 2):
            drawn = slots[b] - slots[a]
            if not (fits[i, a] and fits[j, b]) or abs(math.hypot(*drawn) - length) > tolerance_m:
                continue
            heading_rad = math.atan2(arm[1], arm[0]) - math.atan2(drawn[1], drawn[0])
            turn = rotation(heading_rad)
            center = (places[i] + places[j]) / 2.0 - turn @ ((slots[a] + slots[b]) / 2.0)
            used = _patches_at(places, fits, center + slots @ turn.T, tolerance_m)
            if len(used) > most:
                best, most = (center, heading_rad, used), len(used)
    return best


def _patches_at(places: Floats, fits: np.ndarray, expected: Floats, tolerance_m: float) -> list[int]:
    """The patches nearest to the expected places of the slots, each once."""
    used: list[int] = []
    for slot, place in enumerate(expected):
        away = np.where(fits[:, slot], np.hypot(*(places - place).T), np.inf)
        away[used] = np.inf
        if away.min() <= tolerance_m:
            used.append(int(away.argmin()))
    return used


def _in_place_of_team(scene: Scene, marker: Marker, center: Floats, heading_rad: float) -> str:
    """What is seen where the team's patch should be."""
    x_m, y_m = (center + rotation(heading_rad) @ marker.anchor_m).tolist()
    x, y = pixel_from_field(scene.seen.camera, x_m, y_m, marker.height_m)
    away = np.hypot(scene.blobs["x_px"] - x, scene.blobs["y_px"] - y)
    side, wanted = side_of(*marker.anchor_m.tolist()), " or ".join(TEAMS)
    box = scene.blobs[["left", "top", "right", "bottom"]][int(away.argmin())] if len(away) else None
    if box is not None and box["left"] <= x <= box["right"] and box["top"] <= y <= box["bottom"]:
        name = scene.table.names[int(scene.blobs["color"][int(away.argmin())])]
        return f"its {side} patch is {name}, not {wanted}"
    height, width, _ = scene.seen.pixels.shape
    column, row = min(max(round(x), 1), width - 2), min(max(round(y), 1), height - 2)
    blue, green, red = scene.seen.pixels[row - 1 : row + 2, column - 1 : column + 2].mean(axis=(0, 1)).round()
    levels = f"a color of blue {blue:.0f}, green {green:.0f}, red {red:.0f}"
    return f"at its {side}, ({x:.0f}, {y:.0f}) px, is {levels}, which is neither {' nor '.join(TEAMS)}"
