"""Why robots or ball are not seen, in words, from the stages and from the picture itself.

Slow, so never on the hot path: always for stills; in the service by a process of its own, with a time budget.
"""

from collections.abc import Callable, Iterable, Iterator

import numpy as np

from vision_core.clock import Clock, Instant, MonotonicClock
from vision_core.color.prefilter import prefilter_from
from vision_core.native.kernels import box
from vision_core.objects.ball.reasons import explain_balls
from vision_core.objects.observation import Observation
from vision_core.objects.robots.finder import RobotFinder
from vision_core.objects.robots.held import held_robots
from vision_core.objects.robots.reasons import explain_robots
from vision_core.objects.robots.scene import Scene
from vision_core.pipeline.perception import ALONE, Perception, perceive_picture
from vision_core.regions.exposure import exposure_reasons, field_pixels
from vision_core.regions.lines import line_check
from vision_core.regions.picture_kind import kind_reasons
from vision_core.regions.shift_words import calibration_reasons
from vision_core.types.objects import Sightings
from vision_core.types.reasons import Reason
from vision_core.types.tables import NO_ID, SightingsTable, Table

OVERFLOW = Reason(
    "too many blobs: parts of the picture were not searched", "Narrow the color classes, or raise blobs.max_runs."
)
MIN_LINES = 0.8
"""Share of the painted lines that are in their places when the floor is calibrated rightly."""
CUT_SHORT = Reason("the search for reasons was cut short: there may be more", "Mend what is listed first.")


class _Budget:
    """A deadline, and whether it has stopped any work."""

    def __init__(self, clock: Clock, deadline: Instant | None) -> None:
        self._clock, self._deadline = clock, deadline
        self.was_exceeded = False

    def is_over(self) -> bool:
        self.was_exceeded = self.was_exceeded or (self._deadline is not None and self._clock.now() >= self._deadline)
        return self.was_exceeded


def reasons_of(
    perception: Perception, seen: Sightings, *, deadline: Instant | None = None, clock: Clock | None = None
) -> tuple[Reason, ...]:
    """What explains the sightings of the frame that was perceived last; empty when nothing is wrong.

    What is cheap is looked at first, other patterns and sizes of markers last. Between two steps the clock (None: the
    machine's) is compared with the deadline: after it no step begins, and the last reason is CUT_SHORT. The reasons
    that explain most come first, among equals those of the calibration.
    """
    settings, camera = perception.settings, perception.camera
    if kind := kind_reasons(perception.raw):
        return kind
    exposure = exposure_reasons(perception.raw, field_pixels(settings.field, camera.model, camera.size_px))
    if exposure:  # nothing else can be judged in such a picture
        return exposure
    budget = _Budget(clock or MonotonicClock(), deadline)
    steps: tuple[Callable[[], Iterable[Reason]], ...] = (
        lambda: (perception.lighting.light.reason,) if perception.lighting.light.reason else (),
        lambda: () if seen.complete else (OVERFLOW,),
        lambda: () if seen.robots and seen.balls else color_conflicts(perception),
        lambda: calibration_reasons(perception.raw, settings.field, camera),
        lambda: _ball_reasons(perception, seen),
        lambda: explain_robots(scene_of(perception), settings, budget.is_over, is_floor_right=_lines_agree(perception)),
    )
    reasons = sorted(_until_over(steps, budget), key=lambda reason: (-reason.explains, not reason.is_calibration))
    return (*reasons, CUT_SHORT) if budget.was_exceeded else tuple(reasons)


def _until_over(steps: Iterable[Callable[[], Iterable[Reason]]], budget: _Budget) -> Iterator[Reason]:
    for step in steps:
        if budget.is_over():
            return
        yield from step()


def _lines_agree(perception: Perception) -> bool:
    """Are most painted lines where the calibration puts them?"""
    check = line_check(perception.raw, perception.settings.field, perception.camera.model)
    return check.known > 0 and check.found >= MIN_LINES * check.known


def _ball_reasons(perception: Perception, seen: Sightings) -> tuple[Reason, ...]:
    """Why no blob is the ball."""
    context, table = perception.context, SightingsTable.of(seen)
    observation = Observation(
        perception.blobs, perception.blob_count, perception.pixels, context.classes, context.camera
    )
    return explain_balls(observation, table.robots, len(seen.robots), context.balls, perception.settings.ball.color)


def scene_of(perception: Perception) -> Scene:
    """The frame that was perceived last, with the blobs of all classes: markers of other leagues have other colors.

    Other finders search it through the compiled call of the hot path, so that nothing is compiled for them.
    """
    context = perception.context._replace(
        searched=perception.table.classes,
        prefilter=prefilter_from(perception.table),
        expected=np.zeros_like(perception.context.expected),
        ball=np.zeros_like(perception.context.ball),
        held=held_robots(),
    )
    blobs, seen = np.zeros_like(perception.blobs), SightingsTable()

    def search(finder: RobotFinder) -> tuple[int, Table]:
        boxed = box(context._replace(robots=finder))
        count, _ = perceive_picture(perception.pixels, ALONE, boxed, blobs, seen.whole)
        return count, seen.robots[: seen.counts[0]].copy()

    count, _ = search(context.robots)
    observation = Observation(blobs[:count], count, perception.pixels, context.classes, context.camera)
    robots = perception.robots
    read = robots[(robots["id"] != NO_ID) & ~np.isnan(robots["heading_rad"])]
    return Scene(observation, perception.table, lambda finder: search(finder)[1], read)


def color_conflicts(perception: Perception) -> tuple[Reason, ...]:
    """Color classes that contain the same colors."""
    return tuple(
        Reason(
            f"color classes {first} and {other} claim {count} of the same colors; {first}, listed first, has them",
            f"Narrow one of the two: `pslv colors show` shows what is {first} and what is {other}.",
        )
        for first, other, count in perception.table.disputed
    )
