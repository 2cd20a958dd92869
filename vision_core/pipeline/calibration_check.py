"""What robots in a picture say against a camera that was calibrated by painted lines.

Lines on the floor hardly tell the camera's height, and not at all whether the picture is mirrored; markers of known
size and ids do.
"""

from dataclasses import replace

import msgspec

from vision_core.calibration.result import Calibration
from vision_core.clock import Instant, MonotonicClock
from vision_core.errors import SettingsError
from vision_core.geometry import Bytes
from vision_core.models.camera_setup import CameraSetup
from vision_core.objects.robots.reasons import doubts_of
from vision_core.pipeline.diagnosis import scene_of
from vision_core.pipeline.perception import Perception
from vision_core.settings.schema import Settings
from vision_core.types.image import ImageFrame


def checked_by_robots(result: Calibration, pixels: Bytes, settings: Settings) -> Calibration:
    """The same calibration, refused when robots in its picture contradict it.

    pixels: shape (height, width, 3), blue green red. Without robots, or color classes that find them, nothing changes.
    """
    if not result.accepted:
        return result
    width, height = result.size_px
    camera = msgspec.structs.replace(
        settings.camera, model="pinhole", pinhole=result.camera, homography=None, width_px=width, height_px=height
    )
    field = msgspec.structs.replace(settings.field, **result.measures_m)
    venue = msgspec.structs.replace(settings, camera=camera, field=field)
    try:
        perception = Perception(venue, CameraSetup.from_settings(venue))
    except SettingsError:  # a palette that is not complete yet
        return result
    perception.perceive(ImageFrame(perception.camera.name, 1, Instant(0), pixels), MonotonicClock())
    return replace(result, reasons=tuple(doubts_of(scene_of(perception), venue, is_floor_right=True)))
