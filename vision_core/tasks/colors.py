"""Task: images -> how far their light has drifted from the one that the colors were tuned in."""

from vision_core.color.light import field_samples, light_of
from vision_core.geometry import Bytes
from vision_core.rtdb import records
from vision_core.scheduling.handle import Handle, Step
from vision_core.scheduling.watching import watching
from vision_core.types.regions import ColorDrift


def start(handle: Handle) -> Step:
    """Spread samples over the field, and load the kernel."""
    settings, camera, light = handle.settings, handle.camera, handle.settings.colors.light
    samples = field_samples(camera.model, settings.field, camera.size_px, light.margin_m)

    def look(pixels: Bytes) -> ColorDrift:
        seen = light_of(pixels, samples, light)
        return ColorDrift(seen.gain_bgr, str(seen.reason or ""))

    return watching(handle, records.colors(camera.name), look)
