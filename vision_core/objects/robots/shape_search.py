"""Markers found in a whole picture by their shape alone (``marker_shape``). Slow; for set-up and for recovery.

All places of a grid over the field are tried where the picture is not plain, at all headings; the best ones are then
moved until they fit best.
"""

import math
from typing import NamedTuple

import numpy as np

from vision_core.geometry import Bytes, Floats, frozen
from vision_core.models.camera_kernels import CameraMap, pixel_from_field
from vision_core.native.kernels import kernel
from vision_core.objects.robots.marker_shape import SIZES, Scene, fit_marker, fit_shape, score_of
from vision_core.objects.robots.template import POINTS, Template

HEADINGS = 36
STEP = 0.25
"""Distance between places that are tried, as a share of the smallest patch's width."""
MAX_PLACES = 400_000
"""On a larger field the places lie farther apart."""
PLAIN = 3.0
"""A place is tried where the variance is this many times that of most of the field."""
LEAST_VARIANCE = 0.02
"""In square roots of grey levels: below, there is nothing but noise."""
FIRST_SCORE, LAST_SCORE = 0.25, 0.4
"""What a pose must score on the grid, and in the end."""
MAX_FOUND = 120
APART = 0.6
"""Two markers' middles are at least so far apart, as a share of the marker's size."""
OTHER_TURN_RAD = math.radians(35.0)
"""A heading at least so far from the best one is another one."""
OTHER_SHARE = 0.8
"""Another heading is kept when it scores this share of the best one."""
MAX_POSES = 4
"""Of one marker."""


class Candidate(NamedTuple):
    """Something with the shape of a marker."""

    poses: Floats
    """Score, x [m], y [m], heading [rad] of every way to see it, best first; shape (n, 4)."""
    colors: Floats
    """Mean blue, green, red of every patch, the team's first, in each pose; shape (n, patches, 3)."""


def find_candidates(
    pixels: Bytes, scene: Scene, camera: CameraMap, template: Template, height_m: float,
    half_extent_m: tuple[float, float],
) -> list[Candidate]:  # fmt: skip
    """Everything in a picture that has the shape of a marker, the clearest first.

    pixels: shape (height, width, 3), of which ``scene`` was made; half_extent_m: half of the sides of the rectangle on
    the field that is searched.
    """
    step = STEP * template.smallest_m
    area = 4.0 * half_extent_m[0] * half_extent_m[1]
    step = max(step, math.sqrt(area / MAX_PLACES))
    x = np.arange(-half_extent_m[0], half_extent_m[0] + step / 2.0, step)
    y = np.arange(-half_extent_m[1], half_extent_m[1] + step / 2.0, step)
    variances = np.zeros((len(y), len(x)))
    _measure_variance(scene, camera, x, y, height_m, template.size_m, variances)
    known = variances[np.isfinite(variances)]
    if not len(known):
        return []
    plain = max(PLAIN * float(np.median(known)), LEAST_VARIANCE)
    scores = np.zeros((len(y), len(x)))
    headings = np.zeros((len(y), len(x)))
    _try_places(scene, camera, template, x, y, height_m, variances, plain, scores, headings)
    found: list[Candidate] = []
    places: list[tuple[float, float]] = []
    for index in np.argsort(-scores, axis=None)[: 40 * MAX_FOUND]:
        row, column = divmod(int(index), len(x))
        if scores[row, column] < FIRST_SCORE or len(found) == MAX_FOUND:
            break
        if any(math.dist(place, (x[column], y[row])) < APART * template.size_m for place in places):
            continue
        pose = np.array([0.0, x[column], y[row], headings[row, column], 1.0])
        fit_marker(scene, camera, template, height_m, step, pose)
        if pose[0] < LAST_SCORE or any(math.dist(place, pose[1:3]) < APART * template.size_m for place in places):
            places.append((float(x[column]), float(y[row])))
            continue
        places.append((float(pose[1]), float(pose[2])))
        found.append(_with_other_headings(pixels, scene, camera, template, height_m, step, pose))
    return sorted(found, key=lambda one: -one.poses[0, 0])


def _with_other_headings(
    pixels: Bytes, scene: Scene, camera: CameraMap, template: Template, height_m: float, step: float, best: Floats
) -> Candidate:
    """A candidate with all headings that fit nearly as well as the best one."""
    poses = [best]
    tried = []
    for turn in np.arange(1, HEADINGS) * (math.tau / HEADINGS):
        pose = np.array([0.0, best[1], best[2], best[3] + turn, best[4]])
        pose[0] = score_of(scene, camera, template, height_m, pose[1], pose[2], pose[3], pose[4])
        tried.append(pose)
    for pose in sorted(tried, key=lambda one: -one[0]):
        if len(poses) == MAX_POSES or pose[0] < 0.5 * OTHER_SHARE * best[0]:
            break
        if all(_turn_between(pose[3], other[3]) >= OTHER_TURN_RAD for other in poses):
            fit_shape(scene, camera, template, height_m, step, pose)
            if pose[0] >= OTHER_SHARE * best[0] and all(
                _turn_between(pose[3], other[3]) >= OTHER_TURN_RAD for other in poses
            ):
                poses.append(pose)
    colors = np.zeros((len(poses), template.patches, 3))
    for number, pose in enumerate(poses):
        measure_colors(pixels, camera, template, height_m, pose, colors[number])
    return Candidate(frozen(np.array(poses)), frozen(colors))


def _turn_between(one: float, other: float) -> float:
    return abs((one - other + math.pi) % math.tau - math.pi)


@kernel
def _measure_variance(
    scene: Scene, camera: CameraMap, x_m: Floats, y_m: Floats, height_m: float, size_m: float, variances: Floats
) -> None:
    """Variance of the picture in a cross of points as large as a marker, at every place; nan outside of the picture."""
    pixels, roots = scene.pixels, scene.roots
    height, width, _ = pixels.shape
    for row in range(len(y_m)):
        for column in range(len(x_m)):
            u, v = pixel_from_field(camera, x_m[column], y_m[row], height_m)
            ahead_u, ahead_v = pixel_from_field(camera, x_m[column] + 0.5 * size_m, y_m[row], height_m)
            reach = math.hypot(ahead_u - u, ahead_v - v)
            variances[row, column] = math.nan
            if not (reach <= u < width - reach and reach <= v < height - reach):
                continue
            total = 0.0
            for channel in range(3):
                level = square = 0.0
                for k in range(16):
                    away = (0.25 + 0.25 * (k % 4)) * reach * (1.0 if k < 8 else -1.0)
                    along, across = (away, 0.0) if k // 4 % 2 == 0 else (0.0, away)
                    value = roots[pixels[int(v + across), int(u + along), channel]]
                    level += value
                    square += value * value
                total += square / 16.0 - (level / 16.0) ** 2
            variances[row, column] = total


@kernel
def _try_places(
    scene: Scene, camera: CameraMap, template: Template, x_m: Floats, y_m: Floats, height_m: float,
    variances: Floats, plain: float, scores: Floats, headings: Floats,
) -> None:  # fmt: skip
    """The best heading and its score at every place that is not plain."""
    for row in range(len(y_m)):
        for column in range(len(x_m)):
            if not variances[row, column] >= plain:
                continue
            for number in range(HEADINGS):
                heading = number * 2.0 * math.pi / HEADINGS
                for size in SIZES:
                    score = score_of(scene, camera, template, height_m, x_m[column], y_m[row], heading, size)
                    if score > scores[row, column]:
                        scores[row, column], headings[row, column] = score, heading


@kernel
def measure_colors(
    pixels: Bytes, camera: CameraMap, template: Template, height_m: float, pose: Floats, colors: Floats
) -> None:
    """Mean blue, green, red of every patch at a pose; colors: shape (patches, 3)."""
    height, width, _ = pixels.shape
    c, s = math.cos(pose[3]), math.sin(pose[3])
    for patch in range(template.patches):
        for channel in range(3):
            colors[patch, channel] = 0.0
        for k in range(POINTS):
            along, across = pose[4] * template.points_m[patch, k, 0], pose[4] * template.points_m[patch, k, 1]
            x, y = pose[1] + c * along - s * across, pose[2] + s * along + c * across
            u, v = pixel_from_field(camera, x, y, height_m)
            row, column = min(max(int(v + 0.5), 0), height - 1), min(max(int(u + 0.5), 0), width - 1)
            for channel in range(3):
                colors[patch, channel] += pixels[row, column, channel] / POINTS
