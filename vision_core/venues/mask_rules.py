"""Rules for the masks of a camera."""

from collections.abc import Iterator

import numpy as np

from vision_core.settings.schema import MaskSettings, Settings
from vision_core.venues.violation import Violation

KEY = "camera.masks"
MIN_AREA_PX = 1.0


def mask_violations(settings: Settings) -> Iterator[Violation]:
    """Masks with the name of another, outside of the picture, or without an area."""
    camera = settings.camera
    names = [mask.name for mask in camera.masks]
    if twice := sorted({name for name in names if names.count(name) > 1}):
        yield Violation(KEY, f"two masks of the name {twice[0]!r}", "a name of its own for each mask")
    for mask in camera.masks:
        for x, y in mask.points_px:
            if not (0.0 <= x <= camera.width_px and 0.0 <= y <= camera.height_px):
                accepted = f"points in the picture: 0 to {camera.width_px}, 0 to {camera.height_px} px"
                yield Violation(KEY, f"({x:g}, {y:g}) px of mask {mask.name!r}", accepted)
        if not _area_px(mask) >= MIN_AREA_PX:
            yield Violation(KEY, f"mask {mask.name!r}, whose points lie on one line", "points round an area")


def _area_px(mask: MaskSettings) -> float:
    x, y = np.array(mask.points_px).T
    return abs(float(x @ np.roll(y, -1) - y @ np.roll(x, -1))) / 2.0
