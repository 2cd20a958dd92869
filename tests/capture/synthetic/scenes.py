"""Scenes and settings for tests of the simulated camera."""

from typing import Any

import numpy as np

from vision_core.capture.synthetic.bodies import no_bodies
from vision_core.capture.synthetic.render import Renderer
from vision_core.capture.synthetic.world import Snapshot
from vision_core.geometry import Bytes, Floats
from vision_core.models.camera_setup import CameraSetup
from vision_core.settings.schema import Settings
from vision_core.types.objects import Team
from vision_core.venues.loader import load_settings

PLAIN = {
    "synthetic.read_noise": 0.0,
    "synthetic.shot_noise": 0.0,
    "synthetic.vignetting": 0.0,
    "synthetic.uneven_light": 0.0,
    "synthetic.shadows": 0.0,
    "synthetic.clutter": False,
}
"""No noise, even light, nothing beside the field."""

FAR_AWAY = (50.0, 50.0)


def plain_settings(**options: Any) -> Settings:
    """Settings for pictures in which only geometry counts; options with __ for the dot."""
    return load_settings(options={**PLAIN, **{key.replace("__", "."): value for key, value in options.items()}})


def scene(*robots: tuple[float, ...], ball: tuple[float, ...] = FAR_AWAY) -> Snapshot:
    """Robots and ball from x, y, heading, vx, vy, turn; what is left out is 0."""
    bodies = no_bodies(len(robots) + 1)
    for row, given in zip(bodies, (*robots, ball), strict=True):
        row[: len(given)] = given
    return Snapshot(robots=bodies[:-1], ball=bodies[-1], feet=no_bodies(0))


def render(settings: Settings, *scenes: Snapshot) -> list[Bytes]:
    """The images of scenes whose robots are blue and wear ids 1, 2, ..."""
    worn = tuple((Team.BLUE, number + 1) for number in range(len(scenes[0].robots)))
    renderer = Renderer(settings, CameraSetup.from_settings(settings), worn)
    images = []
    for shown in scenes:
        pixels = CameraSetup.from_settings(settings).black_image()
        renderer.draw(pixels, shown)
        images.append(pixels)
    return images


def blob(weights: Floats) -> tuple[Floats, Floats]:
    """Centroid x, y and variances along x and y of weights, shape (height, width) [px]."""
    v, u = np.mgrid[0 : weights.shape[0], 0 : weights.shape[1]]
    total = weights.sum()
    center = np.array([(u * weights).sum(), (v * weights).sum()]) / total
    spread = np.array([((u - center[0]) ** 2 * weights).sum(), ((v - center[1]) ** 2 * weights).sum()]) / total
    return center, spread
