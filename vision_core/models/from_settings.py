"""Camera and mirror as the settings describe them."""

import numpy as np

from vision_core.models.camera import CameraModel, HomographyCamera, PinholeCamera
from vision_core.models.mirror import Mirror
from vision_core.settings.schema import RobotSettings, Settings, TeamRobotSettings
from vision_core.types.objects import Team


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


def robots_of(robots: RobotSettings, team: Team) -> TeamRobotSettings:
    """Pattern, outline, size and height of a team's robots: its own, or those of all."""
    own = robots.blue if team is Team.BLUE else robots.yellow
    return own or TeamRobotSettings(
        pattern=robots.pattern, outline=robots.outline, radius_m=robots.radius_m, height_m=robots.height_m
    )
