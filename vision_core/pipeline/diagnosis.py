"""Why nothing, or too little, is seen: what the stages and the picture itself have to say, in words.

Slow, and so never on the hot path: for stills every time, in the service by a process of its own.
"""

import numpy as np

from vision_core.color.prefilter import prefilter_from
from vision_core.native.kernels import box
from vision_core.objects.ball.reasons import explain_balls
from vision_core.objects.observation import Observation
from vision_core.objects.robots.finder import RobotFinder
from vision_core.objects.robots.reasons import Scene, explain_robots
from vision_core.pipeline.perception import Perception, perceive_picture
from vision_core.regions.exposure import exposure_reasons, field_pixels
from vision_core.regions.line_fit import shift_reasons
from vision_core.regions.lines import line_reasons
from vision_core.types.objects import Sightings
from vision_core.types.tables import SightingsTable, Table

OVERFLOW = "too many blobs: parts of the picture were not looked at; narrow the color classes or raise blobs.max_runs"


def reasons_of(perception: Perception, seen: Sightings) -> tuple[str, ...]:
    """What explains the frame that was perceived last. seen: what came of it."""
    settings, pixels, eyes = perception.settings, perception.pixels, perception.eyes
    camera = perception.camera
    exposure = exposure_reasons(perception.raw, field_pixels(settings.field, camera.model, camera.size_px))
    if exposure:  # nothing else can be told from such a picture
        return exposure
    table = SightingsTable.of(seen)
    light = (perception.lighting.light.reason,) if perception.lighting.light.reason else ()
    overflow = () if seen.complete else (OVERFLOW,)
    robots = explain_robots(scene_of(perception), settings)
    observation = Observation(perception.blobs, perception.blob_count, pixels, eyes.classes, eyes.camera)
    balls = explain_balls(observation, table.robots, len(seen.robots), eyes.balls, settings.ball.color)
    conflicts = () if seen.robots and seen.balls else disputes(perception)
    lines = line_reasons(perception.raw, settings.field, camera.model)
    lines = lines or shift_reasons(perception.raw, settings.field, camera.model)
    return (*light, *overflow, *robots, *balls, *conflicts, *lines)


def scene_of(perception: Perception) -> Scene:
    """The frame that was perceived last, with the blobs of all classes: other leagues' markers wear other ones.

    Other finders look at it through the compiled call of the hot path, so that nothing is compiled for them.
    """
    every = perception.eyes._replace(
        searched=perception.table.classes,
        prefilter=prefilter_from(perception.table),
        watch=np.zeros_like(perception.eyes.watch),
    )
    blobs, seen = np.zeros_like(perception.blobs), SightingsTable()

    def look(finder: RobotFinder) -> tuple[int, Table]:
        count = perceive_picture(perception.pixels, -1.0, box(every._replace(robots=finder)), blobs, seen.whole)
        return count, seen.robots[: seen.counts[0]].copy()

    count, _ = look(every.robots)
    observation = Observation(blobs[:count], count, perception.pixels, every.classes, every.camera)
    return Scene(observation, perception.table, lambda finder: look(finder)[1])


def disputes(perception: Perception) -> tuple[str, ...]:
    """Color classes that claim the same colors."""
    return tuple(
        f"color classes {first} and {other} claim {count} of the same colors; {first}, listed first, has them"
        for first, other, count in perception.table.disputed
    )
