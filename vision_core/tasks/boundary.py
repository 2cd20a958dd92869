"""Task: images -> where the field ends in them, beside where the venue says that it does."""

from vision_core.regions.boundary import BoundaryFinder
from vision_core.rtdb import records
from vision_core.scheduling.handle import Handle, Step
from vision_core.scheduling.watching import watching


def start(handle: Handle) -> Step:
    """Lay the rays."""
    camera = handle.camera
    finder = BoundaryFinder(handle.settings.field, camera.model, camera.size_px)
    return watching(handle, records.boundary(camera.name), finder.find)
