"""Are the robots' markers as large in the picture as the calibration says? Their patches' distances are a ruler.

The calibration puts patches at the height h of the markers. Where a camera at height H is taken for one at height M, a
marker looks (1 - h / M) / (1 - h / H) times as large if points calibrate the floor, and (M - h) / (H - h) times as
large by a lens of known focal length.
"""

import math

import numpy as np

from vision_core.geometry import Floats
from vision_core.models.camera_kernels import field_from_pixel, pixels_per_square_metre
from vision_core.objects.robots.markers import Marker
from vision_core.objects.robots.scene import Scene, SeenRobots, counted
from vision_core.types.reasons import Reason

MIN_ROBOTS, MIN_PATCHES = 2, 3
"""Robots that must agree; patches that a robot must show, the team's among them."""
MIN_ERROR = 0.05
"""Markers are cut by hand: smaller differences say nothing."""
SEAM_PX = 0.7
"""Patches that touch lose the seam between them, so that their centers are seen so much farther apart, each."""
MIN_CERTAINTY = 4.0
"""A difference counts when it is so many times its standard deviation."""
MAX_HEIGHT_M = 50.0


def size_reason(
    scene: Scene, markers: tuple[Marker, ...], seen: SeenRobots, height_m: float, *, is_floor_right: bool
) -> Reason | None:  # fmt: skip
    """That all markers are larger or smaller in the picture than the calibration says; None where they are not.

    height_m: of the camera, by the calibration; is_floor_right: places on the floor are right whatever the height is.
    """
    sizes = [
        (math.log(size), markers[row["marker"]].height_m)
        for row in seen.hypotheses
        if (size := _size_of(scene, markers[row["marker"]], row)) is not None
    ]
    doubt = max((_doubt(scene, markers[row["marker"]], row) for row in seen.hypotheses), default=0.0)
    if len(sizes) < MIN_ROBOTS:
        return None
    logs = np.array([size for size, _ in sizes])
    size, deviation = float(np.median(logs)), float(logs.std()) / math.sqrt(len(logs))
    if abs(size) < max(math.log1p(MIN_ERROR) + doubt, MIN_CERTAINTY * deviation):
        return None
    ratio = math.exp(size)
    size_words = f"{abs(ratio - 1.0):.0%} {'larger' if ratio > 1.0 else 'smaller'}"
    text = f"the markers of {counted(len(sizes), 'robot')} are {size_words} in the picture than the calibration says"
    marker_m = float(np.median([height for _, height in sizes]))
    likely_m = _likely_height_m(ratio, height_m, marker_m, is_floor_right=is_floor_right)
    where = "the camera's height, the field's measures or the pattern is another one"
    if marker_m < likely_m <= MAX_HEIGHT_M:
        where = f"a camera {likely_m:.1f} m high, not {height_m:.2f} m, would see them so"
    advice = "Measure the camera's height over the floor again, then the field and the markers."
    return Reason(f"{text}: {where}", advice, float(len(sizes)), is_calibration=True)


def _size_of(scene: Scene, marker: Marker, hypothesis: np.void) -> float | None:
    """How large a marker is by its patches' places, as a factor of what its pattern says; None: too few of them."""
    slots = [slot for slot in range(len(marker.slots_m)) if hypothesis["slot_blobs"][slot] >= 0]
    if 1 + len(slots) < min(MIN_PATCHES, 1 + len(marker.slots_m)) or not slots:
        return None
    blobs = [int(hypothesis["anchor"]), *(int(hypothesis["slot_blobs"][slot]) for slot in slots)]
    drawn = np.array([marker.anchor_m, *(marker.slots_m[slot] for slot in slots)])
    there = np.array(
        [
            field_from_pixel(
                scene.seen.camera, float(scene.blobs["x_px"][blob]), float(scene.blobs["y_px"][blob]), marker.height_m
            )
            for blob in blobs
        ]
    )
    return _spread(there) / _spread(drawn)


def _doubt(scene: Scene, marker: Marker, hypothesis: np.void) -> float:
    """By how much a marker may look larger because its patches touch; 0 for round ones, which do not."""
    if (marker.radii_m > 0.0).all() or not len(marker.slots_m):
        return 0.0
    scale2 = pixels_per_square_metre(scene.seen.camera, hypothesis["x_m"], hypothesis["y_m"], marker.height_m)
    drawn = np.array([marker.anchor_m, *marker.slots_m])
    return SEAM_PX / math.sqrt(scale2) / _spread(drawn)


def _spread(points: Floats) -> float:
    """Root mean square distance of points from their mean."""
    return float(np.sqrt(((points - points.mean(axis=0)) ** 2).sum(axis=1).mean()))


def _likely_height_m(ratio: float, height_m: float, marker_m: float, *, is_floor_right: bool) -> float:
    """The height of a camera that sees the markers in their right size; inf where there is none."""
    if not is_floor_right:
        return marker_m + (height_m - marker_m) / ratio
    share = 1.0 - (1.0 - marker_m / height_m) / ratio
    return marker_m / share if share > 0.0 else math.inf
