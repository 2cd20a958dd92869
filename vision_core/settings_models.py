"""Camera and mirror as the settings describe them."""

import numpy as np

from vision_core.camera_model import CameraModel, HomographyCamera, PinholeCamera
from vision_core.mirror_model import Mirror
from vision_core.settings import Settings


def camera_model_from(settings: Settings) -> CameraModel:
    """The camera that the settings describe."""
    camera = settings.camera
    if camera.model == "pinhole":
        lens = camera.pinhole
        return PinholeCamera(lens.focal_px, lens.center_px, lens.distortion, lens.position_m, lens.rotation_deg)
    assert camera.homography is not None
    pixels = np.array([point.pixel_px for point in camera.homography.points])
    places = np.array([point.field_m for point in camera.homography.points])
    return HomographyCamera(pixels, places, camera.homography.position_m)


def mirror_from(settings: Settings) -> Mirror:
    """The default mirror of the settings."""
    return Mirror(settings.mirror.a, settings.mirror.b, settings.mirror.c)
