"""How clearly a picture shows a marker at a pose, by its shape alone: no color has a name here. Compiled kernels.

A pose explains the picture when every region of the pattern has one color and the regions differ. With the levels'
square roots as coordinates, in which a sensor's noise is about the same for dark and bright, that is the share of the
variance that lies between the regions (Fisher's criterion, 1936), times how clearly the patch that stands out least
does so.
"""

import math
from typing import NamedTuple

import numpy as np

from vision_core.geometry import Bytes, Floats, PixelPlaces, frozen
from vision_core.models.camera_kernels import CameraMap, pixel_from_field
from vision_core.native.kernels import kernel, read_only
from vision_core.objects.robots.template import POINTS, Template

MAX_STRETCH = 0.12
"""How much larger or smaller than drawn a marker may be."""
SIZES = (0.9, 1.0)
"""As a share of the drawn one, with which a fit begins: papers are often cut smaller."""
HALVINGS = 4
"""Of the step while a pose is moved to where it fits best."""
LAST_STEP = 0.5 ** (HALVINGS - 1)
"""Of the first one."""
MAX_MOVES = 40
"""At one size of the step."""
LIGHT_WEIGHT = 0.08
NOISE = 0.05
"""Variance of noise, in square roots of grey levels."""
ROOTS: Floats = frozen(np.sqrt(np.arange(256.0)))
"""The coordinate of each grey level."""


class Scene(NamedTuple):
    """A picture whose markers are looked for by their shape. Kernels take it as one argument."""

    pixels: Bytes
    """Shape (height, width, 3)."""
    roots: Floats
    """ROOTS."""
    plain: Floats
    """Blue minus green, red minus green and the sum of all three on most of the field, in roots; shape (3,)."""


def scene_of(pixels: Bytes, floor: PixelPlaces) -> Scene:
    """A picture to be searched. pixels: shape (height, width, 3); floor: pixels of the field."""
    blue, green, red = ROOTS[pixels[floor[:, 1], floor[:, 0]]].T
    plain = np.array([np.median(blue - green), np.median(red - green), np.median(blue + green + red)])
    return Scene(read_only(pixels), ROOTS, frozen(plain))


@kernel
def fit_marker(
    scene: Scene, camera: CameraMap, template: Template, height_m: float, step_m: float, pose: Floats
) -> None:  # fmt: skip
    """Move a pose to the best one near it, as ``fit_shape`` does from each of SIZES: one of them may be stuck."""
    best, x, y, heading, size = -1.0, pose[1], pose[2], pose[3], pose[4]
    start_x, start_y, start_heading = x, y, heading
    for number in range(len(SIZES)):
        pose[1], pose[2], pose[3], pose[4] = start_x, start_y, start_heading, SIZES[number]
        fit_shape(scene, camera, template, height_m, step_m, pose)
        if pose[0] > best:
            best, x, y, heading, size = pose[0], pose[1], pose[2], pose[3], pose[4]
    pose[0], pose[1], pose[2], pose[3], pose[4] = best, x, y, heading, size


@kernel
def fit_shape(
    scene: Scene, camera: CameraMap, template: Template, height_m: float, step_m: float, pose: Floats
) -> None:
    """Move a pose (score, x, y, heading, size) to the best one near it.

    step_m: the first step; the last one is LAST_STEP of it.
    """
    pose[0] = score_of(scene, camera, template, height_m, pose[1], pose[2], pose[3], pose[4])
    step = step_m
    for _ in range(HALVINGS):
        for _ in range(MAX_MOVES):
            if not _moved(scene, camera, template, height_m, step, pose):
                break
        step *= 0.5


@kernel
def _moved(scene: Scene, camera: CameraMap, template: Template, height_m: float, step_m: float, pose: Floats) -> bool:
    """Try a step along every axis; whether one was taken."""
    moved = False
    for axis in range(1, 5):
        size = step_m if axis < 3 else 2.0 * step_m / template.size_m
        for sign in (-1.0, 1.0):
            before = pose[axis]
            pose[axis] = before + sign * size
            score = 0.0
            if 1.0 - MAX_STRETCH <= pose[4] <= 1.0 + MAX_STRETCH:
                score = score_of(scene, camera, template, height_m, pose[1], pose[2], pose[3], pose[4])
            if score > pose[0] + 1e-6:
                pose[0], moved = score, True
            else:
                pose[axis] = before
    return moved


@kernel
def score_of(
    scene: Scene, camera: CameraMap, template: Template, height_m: float, x_m: float, y_m: float, heading_rad: float,
    size: float,
) -> float:  # fmt: skip
    """How well a marker at a pose explains the picture, 0..1; 0 where it does not lie in the picture."""
    pixels, roots = scene.pixels, scene.roots
    height, width, _ = pixels.shape
    arm = 0.5 * template.size_m
    c, s = math.cos(heading_rad), math.sin(heading_rad)
    u0, v0 = pixel_from_field(camera, x_m, y_m, height_m)
    ahead_u, ahead_v = pixel_from_field(camera, x_m + c * arm, y_m + s * arm, height_m)
    left_u, left_v = pixel_from_field(camera, x_m - s * arm, y_m + c * arm, height_m)
    ahead_x, ahead_y, left_x, left_y = (
        (ahead_u - u0) / arm,
        (ahead_v - v0) / arm,
        (left_u - u0) / arm,
        (left_v - v0) / arm,
    )
    points = template.points_m
    counted = template.patches + 1
    # the region that the patches are compared with comes first
    ref_one = ref_two = ref_sum = 0.0
    all_b = all_g = all_r = squares = within = 0.0
    least = 1.0
    for turn in range(counted):
        region = (template.patches + turn) % counted
        is_tinted = turn == 0 or template.tinted[region]
        b = g = r = lights = hues = 0.0
        for k in range(POINTS):
            along, across = size * points[region, k, 0], size * points[region, k, 1]
            column, row = (
                int(u0 + along * ahead_x + across * left_x + 0.5),
                int(v0 + along * ahead_y + across * left_y + 0.5),
            )
            if not (0 <= column < width and 0 <= row < height):
                return 0.0
            blue, green, red = (
                roots[pixels[row, column, 0]],
                roots[pixels[row, column, 1]],
                roots[pixels[row, column, 2]],
            )
            b += blue
            g += green
            r += red
            light = blue + green + red
            lights += light * light
            hues += (blue - green) ** 2 + (red - green) ** 2
        b, g, r = b / POINTS, g / POINTS, r / POINTS
        # variances; a pale region may have any colors
        uneven_light = max(lights / POINTS - (b + g + r) ** 2, 0.0)
        uneven = max(hues / POINTS - (b - g) ** 2 - (r - g) ** 2, 0.0) if is_tinted else uneven_light / 3.0
        own = LIGHT_WEIGHT * uneven_light + (uneven if is_tinted else 0.0)
        if turn == 0:
            ref_one, ref_two, ref_sum = scene.plain[0], scene.plain[1], scene.plain[2]
            if template.has_between:
                ref_one, ref_two, ref_sum = b - g, r - g, b + g + r
        else:
            one, two = b - g, r - g
            contrast = (one - ref_one) ** 2 + (two - ref_two) ** 2
            if not is_tinted:
                contrast += (b + g + r - ref_sum) ** 2 / 3.0
            least = min(least, contrast / (contrast + 2.0 * uneven + 2.0 * NOISE))
        if turn > 0 or template.has_between:
            within += own
            all_b += b
            all_g += g
            all_r += r
            squares += own + _squared(b - g, r - g, b + g + r)
    n = float(counted if template.has_between else template.patches)
    if n > 1.0:
        variance = squares / n - _squared(all_b - all_g, all_r - all_g, all_b + all_g + all_r) / (n * n)
        share = 1.0 - within / n / max(variance + NOISE / 4.0, 1e-9)
    else:
        share = 1.0
    return max(share, 0.0) * least


@kernel
def _squared(one: float, two: float, light: float) -> float:
    """Squared length of a color: shadows change the light more than the hue, so it weighs less."""
    return one * one + two * two + LIGHT_WEIGHT * light * light
