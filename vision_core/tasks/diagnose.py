"""Task: images -> why robots or ball are not seen. Examines one image now and then, when there is time."""

from vision_core.clock import after
from vision_core.pipeline.diagnosis import reasons_of
from vision_core.pipeline.live_colors import LiveColors
from vision_core.pipeline.live_suggestions import SuggestedRobots
from vision_core.pipeline.perception import Perception
from vision_core.rtdb import records
from vision_core.scheduling.handle import Handle, Step
from vision_core.scheduling.latest_image import Images
from vision_core.scheduling.releases import RAN, Release, StepResult
from vision_core.types.objects import Diagnosis

BUDGET_S = 0.5
"""After this time no further step of the search for reasons begins: what is found by then is published."""


def start(handle: Handle) -> Step:
    """Load the kernels."""
    camera = handle.camera.name
    perception = Perception(handle.settings, handle.camera)
    perception.warm_up()
    colors = LiveColors(perception, handle.reader(records.palette(camera)))
    suggested = SuggestedRobots(perception, handle.reader(records.suggestions(camera)))
    images = Images(handle)
    writer = handle.writer(records.diagnosis(camera))

    def step(_release: Release) -> StepResult:
        image = images.newest()
        if image is None:
            return images.none_result
        deadline = after(handle.clock.now(), BUDGET_S)
        colors.refresh(handle.clock.now())
        suggested.refresh(handle.clock.now())
        seen = perception.perceive(image, handle.clock).record()
        reasons = reasons_of(perception, seen, deadline=deadline, clock=handle.clock)
        writer.write(Diagnosis(camera, image.number, image.grabbed, reasons), image.grabbed, handle.clock.now())
        return RAN

    return step
