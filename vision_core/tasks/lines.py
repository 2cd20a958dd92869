"""Task: images -> whether the painted lines are where they should be: has the camera been bumped?"""

from vision_core.geometry import Bytes
from vision_core.regions.lines import line_check
from vision_core.rtdb import records
from vision_core.scheduling.handle import Handle, Step
from vision_core.scheduling.watching import watching
from vision_core.types.regions import LineCheck


def start(handle: Handle) -> Step:
    """Make the camera's model."""
    field, camera = handle.settings.field, handle.camera.model

    def look(pixels: Bytes) -> LineCheck:
        return line_check(pixels, field, camera)

    return watching(handle, records.lines(handle.camera.name), look)
