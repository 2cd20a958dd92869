"""Task: images -> whether the painted lines are where they should be: has the camera been bumped, and how?"""

from dataclasses import replace

from vision_core.geometry import Bytes, Floats, Mask
from vision_core.pipeline.robot_contours import RobotContours
from vision_core.regions.lines import line_check
from vision_core.regions.shift_words import displaced_reasons
from vision_core.rtdb import records
from vision_core.scheduling.handle import Handle, Step
from vision_core.scheduling.watching import watching
from vision_core.types.regions import LineCheck


def start(handle: Handle) -> Step:
    """Make the camera's model."""
    field, setup = handle.settings.field, handle.camera

    contours, sightings = RobotContours(handle.settings, setup), handle.reader(records.sightings(setup.name))

    def covered(points_m: Floats) -> Mask:
        """Which points of the floor robots cover at the moment."""
        seen = sightings.read(handle.clock.now())
        return contours.covered(points_m, seen.value.robots if seen and seen.valid else ())

    def look(pixels: Bytes) -> LineCheck:
        check = line_check(pixels, field, setup.model, covered)
        return replace(check, reasons=displaced_reasons(pixels, field, setup))

    return watching(handle, records.lines(handle.camera.name), look)
