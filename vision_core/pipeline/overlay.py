"""What is drawn over a camera's picture: the stages' results on one image, and what they reject, with the reason.

Slow, so never on the hot path. Each layer is computed only when it is asked for. An overlay has a bounded size: of
blobs and hypotheses the largest or best are kept, and a picture of classes is made coarser until it fits.
"""

from collections.abc import Collection

import numpy as np

from vision_core.clock import Clock
from vision_core.errors import SettingsError
from vision_core.geometry import Bytes, Mask
from vision_core.native.opencv import encode_png
from vision_core.objects.ball.verdicts import ball_verdicts
from vision_core.objects.robots.scene import Scene
from vision_core.objects.robots.verdicts import robot_verdicts
from vision_core.pipeline.diagnosis import scene_of
from vision_core.pipeline.perception import Perception
from vision_core.pipeline.robot_contours import RobotContours
from vision_core.regions.boundary import BoundaryFinder
from vision_core.regions.lines import judged_lines
from vision_core.types.colors import ColorTable
from vision_core.types.image import ImageFrame
from vision_core.types.overlay import (
    Blobs,
    ClassColor,
    ClassPicture,
    Hypotheses,
    Layer,
    Overlay,
    PaintedLine,
    ShownBlob,
)
from vision_core.types.tables import SightingsTable

MAX_BLOBS = 200
MAX_HYPOTHESES = 100
CLASSES_WIDTH_PX = 480
"""Largest width of the picture of classes."""
MAX_PNG_BYTES = 196_608
"""A picture of classes is coarser when it would be larger: noise has one blob per pixel."""


class OverlayMaker:
    """Makes overlays of one camera's images."""

    def __init__(self, perception: Perception) -> None:
        """perception: one that nobody else uses. Raises SettingsError for wrong patterns."""
        self._perception = perception
        settings, camera = perception.settings, perception.camera
        self._boundary = BoundaryFinder(settings.field, camera.model, camera.size_px)
        self._contours = RobotContours(settings, camera)

    def make(self, image: ImageFrame, layers: Collection[Layer], clock: Clock) -> Overlay:
        """The layers of an image of the configured size."""
        perception = self._perception
        seen = perception.perceive(image, clock)
        scene = scene_of(perception) if {Layer.BLOBS, Layer.HYPOTHESES} & set(layers) else None
        return Overlay(
            camera=image.camera,
            frame_number=image.number,
            grabbed=image.grabbed,
            classes=class_picture(perception.pixels, perception.table, perception.camera.masked)
            if Layer.CLASSES in layers
            else None,
            blobs=_blobs(scene) if scene and Layer.BLOBS in layers else None,
            hypotheses=self._hypotheses(scene, seen) if scene and Layer.HYPOTHESES in layers else None,
            lines=self._lines(image.pixels) if Layer.LINES in layers else None,
            boundary=self._boundary.find(image.pixels) if Layer.BOUNDARY in layers else None,
            contours=self._contours.of(seen.record().robots) if Layer.CONTOURS in layers else None,
        )

    def _hypotheses(self, scene: Scene, seen: SightingsTable) -> Hypotheses:
        """The verdicts on all blobs that could be a robot's or the ball."""
        perception = self._perception
        finder = perception.context.robots
        robots = int(seen.counts[0])
        verdicts = [
            *robot_verdicts(scene, finder, perception.settings),
            *ball_verdicts(scene.seen, seen.robots, robots, perception.context.balls),
        ]
        verdicts.sort(
            key=lambda verdict: (verdict[1].is_accepted, verdict[0], verdict[1].confidence or 0.0), reverse=True
        )
        return Hypotheses(tuple(shown for _, shown in verdicts[:MAX_HYPOTHESES]), len(verdicts))

    def _lines(self, pixels: Bytes) -> tuple[PaintedLine, ...]:
        """The painted lines; () with a camera that makes them wider than the picture."""
        try:
            return judged_lines(pixels, self._perception.settings.field, self._perception.camera.model)
        except SettingsError:
            return ()


def class_picture(pixels: Bytes, table: ColorTable, masked: Mask | None = None) -> ClassPicture:
    """The color classes of a picture, as fine as MAX_PNG_BYTES allows; masked pixels have none.

    pixels: shape (height, width, 3); masked: shape (height, width).
    """
    step = -(-pixels.shape[1] // CLASSES_WIDTH_PX)
    while True:
        classes = table.classes_of(pixels[::step, ::step])
        if masked is not None:
            classes[masked[::step, ::step]] = 0
        png = encode_png(classes)
        if len(png) <= MAX_PNG_BYTES or step >= min(pixels.shape[:2]):
            break
        step *= 2
    colors = zip(table.names[1:], table.mean_bgr[1:].tolist(), strict=True)
    return ClassPicture(step, png, tuple(ClassColor(name, (b, g, r)) for name, (b, g, r) in colors))


def _blobs(scene: Scene) -> Blobs:
    """The largest blobs of a frame."""
    rows = scene.blobs
    largest = np.argsort(-rows["area_px"], kind="stable")[:MAX_BLOBS]
    shown = tuple(
        ShownBlob(
            color=scene.table.names[row["color"]],
            x_px=round(float(row["x_px"]), 1),
            y_px=round(float(row["y_px"]), 1),
            area_px=int(row["area_px"]),
            box_px=(int(row["left"]), int(row["top"]), int(row["right"]), int(row["bottom"])),
        )
        for row in rows[largest]
    )
    return Blobs(shown, len(rows))
