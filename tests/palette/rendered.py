"""Rendered pictures of the demo's fields, with the papers of other suppliers."""

import colorsys
from collections.abc import Mapping

import numpy as np
import pytest

from vision_core.capture.synthetic import render
from vision_core.capture.synthetic.camera import SyntheticCamera
from vision_core.capture.synthetic.truth import Truth
from vision_core.clock import Instant, ManualClock
from vision_core.geometry import Bytes
from vision_core.models.camera_setup import CameraSetup
from vision_core.palette.trial import Judged
from vision_core.patterns.paints import PAINTS_BGR
from vision_core.settings.schema import Settings
from vision_core.types.tables import TEAMS

Color = tuple[int, int, int]
NEAR_M = 0.03


def other_paper(bgr: Color, hue_deg: float, saturation: float) -> Color:
    """A paper of another supplier: its hue turned, its saturation multiplied."""
    blue, green, red = (level / 255.0 for level in bgr)
    hue, pure, value = colorsys.rgb_to_hsv(red, green, blue)
    red, green, blue = colorsys.hsv_to_rgb((hue + hue_deg / 360.0) % 1.0, pure * saturation, value)
    return round(255 * blue), round(255 * green), round(255 * red)


def papers(seed: int) -> dict[str, Color]:
    """A set of papers: every hue up to 12 degrees off, every saturation down to 0.7 of the usual one."""
    rng = np.random.default_rng(seed)
    return {name: other_paper(bgr, rng.uniform(-12, 12), rng.uniform(0.7, 1.0)) for name, bgr in PAINTS_BGR.items()}


def rendered(
    settings: Settings, paints: Mapping[str, Color], monkeypatch: pytest.MonkeyPatch, count: int
) -> list[tuple[Bytes, Truth]]:
    """Pictures of a simulated match, a second apart, with what they show."""
    monkeypatch.setattr(render, "PAINTS_BGR", dict(paints))
    setup = CameraSetup.from_settings(settings)
    clock = ManualClock(Instant(100))
    camera = SyntheticCamera(settings, setup, clock, paced=False)
    shown = []
    for _ in range(count):
        for _ in range(round(setup.rate_hz)):
            pixels = setup.black_image()
            camera.grab(pixels)
        shown.append((pixels, camera.truth))
    return shown


def right_and_wrong(judged: Judged, truth: Truth) -> tuple[int, int, int]:
    """True robots in the picture, those read with their id, and those read with another one."""
    true = [robot for robot in truth.robots if robot.in_picture]
    right = wrong = 0
    for robot in true:
        for seen in judged.robots:
            near = np.hypot(seen["x_m"] - robot.x_m, seen["y_m"] - robot.y_m) < NEAR_M
            if near and TEAMS[seen["team"]] == robot.team and seen["id"] >= 0:
                right, wrong = right + (seen["id"] == robot.id), wrong + (seen["id"] != robot.id)
    return len(true), right, wrong
