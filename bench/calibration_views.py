"""Rendered pictures of the Small Size field of 2002 by cameras with random lens and pose, and how wrong a result is.

The camera hangs at about 4 m; a pixel covers about 5 mm. Robots, people's feet, bags and cables are in the picture.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from vision_core.calibration.lens import Lens
from vision_core.capture.synthetic.camera import SyntheticCamera
from vision_core.clock import MonotonicClock
from vision_core.geometry import Bytes, Floats
from vision_core.models.camera import CameraModel, PinholeCamera
from vision_core.models.camera_setup import CameraSetup
from vision_core.settings.schema import FieldSettings, PinholeSettings, Settings
from vision_core.venues.loader import load_settings

WIDTH_PX, HEIGHT_PX, FOCAL_PX = 780, 580, 800.0
START_DEG, START_M = 3.0, 0.1
"""A start is off by up to so much in every angle and coordinate."""


@dataclass(frozen=True)
class View:
    """A picture, the camera that took it, and a camera to start from."""

    settings: Settings
    pixels: Bytes
    truth: CameraModel
    start: Lens


def view(seed: int, **options: Any) -> View:
    """The picture of a seed; options: settings by their keys with __ for dots."""
    rng = np.random.default_rng([seed, 17])
    center = np.array([(WIDTH_PX - 1) / 2.0, (HEIGHT_PX - 1) / 2.0])
    position = [*rng.uniform(-0.1, 0.1, 2).tolist(), 4.0 + float(rng.uniform(-0.1, 0.1))]
    angles = rng.uniform(-2.0, 2.0, 3)
    keys = {
        "camera.width_px": WIDTH_PX,
        "camera.height_px": HEIGHT_PX,
        "camera.pinhole.focal_px": FOCAL_PX * float(rng.uniform(0.95, 1.05)),
        "camera.pinhole.center_px": (center + rng.uniform(-6.0, 6.0, 2)).tolist(),
        "camera.pinhole.distortion": [float(rng.uniform(-0.12, 0.02)), float(rng.uniform(-0.02, 0.03)),
                                      *rng.uniform(-5e-4, 5e-4, 2).tolist(), 0.0],
        "camera.pinhole.position_m": position,
        "camera.pinhole.rotation_deg": angles.tolist(),
        "synthetic.seed": seed,
    }  # fmt: skip
    keys |= {key.replace("__", "."): value for key, value in options.items()}
    settings = load_settings(options=keys)
    camera = CameraSetup.from_settings(settings)
    source = SyntheticCamera(settings, camera, MonotonicClock(), paced=False)
    pixels = camera.black_image()
    source.grab(pixels)
    off_m, off_deg = rng.uniform(-START_M, START_M, 3), rng.uniform(-START_DEG, START_DEG, 3)
    beside = [a + b for a, b in zip(keys["camera.pinhole.position_m"], off_m.tolist(), strict=True)]
    turned = [a + b for a, b in zip(keys["camera.pinhole.rotation_deg"], off_deg.tolist(), strict=True)]
    start = PinholeCamera(FOCAL_PX, center.tolist(), [0.0] * 5, beside, turned)
    return View(settings, pixels, camera.model, Lens.from_camera(start))


def floor_error_m(lens: PinholeSettings, truth: CameraModel, field: FieldSettings) -> float:
    """The largest distance on the field's floor between two cameras' ideas of one pixel, whichever end is left [m]."""
    x, y = (np.linspace(-0.5, 0.5, 15) * side for side in (field.length_m, field.width_m))
    places = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
    pixels = truth.pixel_from_field(places)
    inside = ((pixels >= 0.0) & (pixels <= (WIDTH_PX - 1.0, HEIGHT_PX - 1.0))).all(axis=1)
    seen: Floats = Lens.from_settings(lens).camera().field_from_pixel(pixels[inside])
    return float(min(np.hypot(*(seen - sign * places[inside]).T).max() for sign in (1.0, -1.0)))
