"""How a field lies in the picture: one that is turned by half is in order, but often its ends were exchanged."""

import math
from collections.abc import Iterator

import numpy as np

from vision_core.models.camera_setup import CameraSetup
from vision_core.settings.schema import NamedPoint, Settings
from vision_core.venues.violation import Violation

MAX_OFF_DEG = 40.0
"""A field that is turned by 180 deg, give or take so much, is turned by half."""
AHEAD_M = 0.05
SIDES = {"left": (0, -1), "right": (0, 1), "top": (1, 1), "upper": (1, 1), "bottom": (1, -1), "lower": (1, -1)}
"""Words in names of points: the axis of field_m, and its sign there."""


def orientation_warnings(settings: Settings, setup: CameraSetup) -> Iterator[Violation]:
    """A field that is turned by half in the picture, and points whose names contradict their places."""
    start, ahead = setup.model.pixel_from_field(np.array([(0.0, 0.0), (AHEAD_M, 0.0)]))
    turn_deg = math.degrees(math.atan2(start[1] - ahead[1], ahead[0] - start[0]))
    if abs(turn_deg) > 180.0 - MAX_OFF_DEG:
        found = "the left goal, at negative x, lies on the right of the picture"
        accepted = "that if the camera is mounted so; else exchange the ends of the field"
        yield Violation(f"camera.{settings.camera.model}", found, accepted)
    named = settings.camera.homography if settings.camera.model == "homography" else None
    if named is None:
        return
    middle = np.mean([point.pixel_px for point in named.points], axis=0)
    for point in named.points:
        if word := _wrong_word(point, (np.array(point.pixel_px) - middle) * (1.0, -1.0)):
            x, y = point.field_m
            found = f"{point.name!r} has field_m = [{x:g}, {y:g}], which is not {word}, nor is it in the picture"
            yield Violation("camera.homography.points", found, "left: x < 0; right: x > 0; top: y > 0; bottom: y < 0")


def _wrong_word(point: NamedPoint, in_picture: np.ndarray) -> str:
    """A word of a point's name that fits neither its place on the field nor that in the picture; empty for none.

    in_picture: x to the right and y up from the middle of all points, shape (2,).
    """
    for word in sorted(set(point.name.lower().replace("-", " ").replace("_", " ").split()) & SIDES.keys()):
        axis, sign = SIDES[word]
        if point.field_m[axis] * sign < 0.0 and in_picture[axis] * sign < 0.0:
            return word
    return ""
