"""Millimetres of floor per pixel, on board and under the ceiling: where they are alike (section 4.3 of the paper)."""

import math

import numpy as np

from vision_core.geometry import Floats
from vision_core.models.camera_setup import CameraSetup
from vision_core.models.mirror import Mirror
from vision_core.settings.schema import Settings

NEAREST_MM, FARTHEST_MM = 50.0, 5000.0


def mm_per_px_onboard(mirror: Mirror, distance_mm: Floats, scale: float = 1.0) -> tuple[Floats, Floats]:
    """Across and along the line of sight, at distances on the floor.

    scale: pixels of the picture per pixel of equation 1. Across it is r / R, along it dr / dR.
    """
    px = mirror.px_from_mm(distance_mm)
    step = 0.5
    along = (mirror.mm_from_px(px + step) - mirror.mm_from_px(px - step)) / (2.0 * step)
    return distance_mm / px / scale, along / scale


def mm_per_px_ceiling(settings: Settings) -> float:
    """Of the ceiling camera, at the middle of the floor."""
    camera = CameraSetup.from_settings(settings).model
    return 1e3 / math.sqrt(float(camera.pixels_per_square_metre(np.zeros((1, 2)))[0]))


def crossing_mm(mirror: Mirror, ceiling_mm_per_px: float, scale: float = 1.0) -> tuple[float, float]:
    """From which distances on the on-board camera is the coarser one, across and along; nan: it always is."""
    distances = np.arange(NEAREST_MM, FARTHEST_MM)
    found = []
    for mm_per_px in mm_per_px_onboard(mirror, distances, scale):
        coarser = np.isfinite(mm_per_px) & (mm_per_px > ceiling_mm_per_px)
        first = int(np.argmax(coarser))
        found.append(float(distances[first]) if coarser.any() and first else float("nan"))
    return found[0], found[1]
