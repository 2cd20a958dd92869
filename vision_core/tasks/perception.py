"""The second to fourth stage composed: a frame in, sightings out."""

import numpy as np

from vision_core.blobs.run_lengths import Segmenter
from vision_core.clock import Clock, Instant, ManualClock
from vision_core.color.light import Lighting
from vision_core.color.lookup_table import compile_color_table, keep_classes
from vision_core.errors import SettingsError
from vision_core.objects.ball import find_balls
from vision_core.objects.patterns import marker_from
from vision_core.objects.robots import TEAMS, find_robots
from vision_core.pattern_files import load_pattern
from vision_core.settings import Settings
from vision_core.settings_models import camera_model_from
from vision_core.types.image import ImageFrame
from vision_core.types.objects import Sightings

OVERFLOW = "too many blobs: parts of the picture were not looked at; narrow the color classes or raise blobs.max_runs"


class Perception:
    """Perceives the frames of one camera. Holds tables and memory, but nothing of past frames.

    Raises SettingsError when the pattern file is missing or wrong, or wears colors without a class.
    """

    def __init__(self, settings: Settings) -> None:
        self.settings = settings
        self.table = compile_color_table(settings.colors)
        self._marker = marker_from(load_pattern(settings.robots.pattern))
        if unknown := [color for color in self._marker.dot_colors if color not in self.table.names]:
            raise SettingsError(
                f"pattern {settings.robots.pattern}: dot_colors",
                found=", ".join(unknown),
                accepted=f"classes of colors.classes: {', '.join(settings.colors.classes)}",
            )
        self._searched = keep_classes(self.table, {*TEAMS, *self._marker.dot_colors, settings.ball.color})
        self._conflicts = tuple(
            f"color classes {first} and {other} claim {count} of the same colors; {first}, listed first, has them"
            for first, other, count in self.table.disputed
        )
        self._camera = camera_model_from(settings)
        self.lighting = Lighting(settings, self._camera)
        self._segmenter = Segmenter(settings.camera.width_px, settings.camera.height_px, settings.blobs)

    def warm_up(self) -> None:
        """Load or compile the kernels, so that no frame waits for them."""
        size = (self.settings.camera.height_px, self.settings.camera.width_px, 3)
        dark = ImageFrame(self.settings.camera.name, 0, Instant(0), np.zeros(size, dtype=np.uint8))
        self.perceive(dark, ManualClock())
        self.lighting.warm_up()

    def perceive(self, frame: ImageFrame, clock: Clock) -> Sightings:
        """What a frame of the configured size shows, judged alone."""
        settings = self.settings
        pixels = self.lighting.lit(frame.pixels, frame.grabbed)
        blobs = self._segmenter.segment(pixels, self._searched)
        robots, robot_reasons = find_robots(blobs, self.table, self._camera, self._marker, settings.robots)
        balls, ball_reasons = find_balls(blobs, self.table, pixels, self._camera, robots, settings.ball, settings.field)
        overflow = () if blobs.complete else (OVERFLOW,)
        light = (self.lighting.light.reason,) if self.lighting.light.reason else ()
        conflicts = () if robots and balls else self._conflicts
        return Sightings(
            camera=frame.camera,
            frame_number=frame.number,
            grabbed=frame.grabbed,
            perceived=clock.now(),
            robots=robots,
            balls=balls,
            reasons=(*light, *overflow, *robot_reasons, *ball_reasons, *conflicts),
        )
