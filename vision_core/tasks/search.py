"""Task: images -> robots that the blobs do not show. The task ``perceive`` looks for them there from its next image on.

Searching a picture for the shapes of markers takes a fraction of a second. So it is done when the blobs of an image
show fewer robots than there were lately, and otherwise once in a while. Each image is judged alone: a robot that this
task holds from image to image may be lost to ``perceive``.
"""

from vision_core.objects.robots.held import is_read
from vision_core.pipeline.live_colors import LiveColors
from vision_core.pipeline.live_suggestions import live_from
from vision_core.pipeline.perception import Perception
from vision_core.rtdb import records
from vision_core.scheduling.handle import Handle, Step
from vision_core.scheduling.latest_image import Images
from vision_core.scheduling.releases import IDLE, RAN, Release, StepResult

REST = 10
"""Where all robots are read, one image of so many is searched."""
REMEMBERED = 60
"""Images for which the largest number of robots, read or found by their shape, is remembered."""


def start(handle: Handle) -> Step:
    """Load the kernels."""
    camera = handle.camera
    perception = Perception(handle.settings, camera)
    perception.warm_up()
    colors = LiveColors(perception, handle.reader(records.palette(camera.name)))
    images = Images(handle)
    writer = handle.writer(records.suggestions(camera.name))
    most = age = rest = last = 0

    def step(_release: Release) -> StepResult:
        nonlocal most, age, rest, last
        image = images.newest()
        if image is None:
            return images.none_result
        if image.number == last:
            return IDLE
        last = image.number
        colors.refresh(handle.clock.now())
        perception.perceive_alone(image, handle.clock)
        read = sum(map(is_read, perception.robots))
        age += 1
        if read >= most or age > REMEMBERED:
            most, age = read, 0
        rest -= 1
        if read >= most and rest > 0:
            return RAN
        rest = REST
        found = perception.unseen_robots()
        if read + len(found.poses) >= most:
            most, age = read + len(found.poses), 0
        writer.write(live_from(found), image.grabbed, handle.clock.now())
        return RAN

    return step
