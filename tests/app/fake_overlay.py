"""The overlay that a fake service draws, while somebody looks: a marker of the wrong size and a missed line in it."""

import math

import numpy as np

from tests.app.fake_tasks import BLUE_3
from vision_core.color.lookup_table import compile_color_table
from vision_core.geometry import Bytes
from vision_core.models.camera_setup import CameraSetup
from vision_core.models.field import painted_points
from vision_core.pipeline.overlay import class_picture
from vision_core.settings.schema import Settings
from vision_core.types.objects import Sightings
from vision_core.types.overlay import (
    Blobs,
    Hypotheses,
    Hypothesis,
    Layer,
    Looking,
    Overlay,
    PaintedLine,
    ShownBlob,
)
from vision_core.types.regions import FieldBoundary

BLOBS = 340
REJECTED_PX = (200.0, 120.0)


class FakeOverlays:
    """Draws overlays of fake pictures."""

    def __init__(self, settings: Settings) -> None:
        self._camera = CameraSetup.from_settings(settings)
        self._table = compile_color_table(settings.colors)
        lines = [self._camera.model.pixel_from_field(points) for points in painted_points(settings.field, 16)]
        self._lines = tuple(
            PaintedLine(_points(line), True, 0.3)
            if number
            else PaintedLine(_points(line), False, None, "paint on 12% of its length", "more than 50%")
            for number, line in enumerate(lines)
        )

    def drawn(self, look: Looking, seen: Sightings, pixels: Bytes) -> Overlay:
        """The layers that are looked at."""

        def asked(layer: Layer) -> bool:
            return layer in look.layers

        hypotheses = _hypotheses(seen)
        return Overlay(
            seen.camera,
            seen.frame_number,
            seen.grabbed,
            classes=class_picture(pixels, self._table) if asked(Layer.CLASSES) else None,
            blobs=_blobs(hypotheses) if asked(Layer.BLOBS) else None,
            hypotheses=hypotheses if asked(Layer.HYPOTHESES) else None,
            lines=self._lines if asked(Layer.LINES) else None,
            contours=(BLUE_3,) if asked(Layer.CONTOURS) else None,
            boundary=self._boundary() if asked(Layer.BOUNDARY) else None,
        )

    def _boundary(self) -> FieldBoundary:
        width, height = self._camera.size_px
        angles = np.linspace(0.0, math.tau, 120, endpoint=False)
        x, y = width * (0.5 + 0.45 * np.cos(angles)), height * (0.5 + 0.45 * np.sin(angles))
        x[:5] = np.nan
        points = tuple((float(a), float(b)) for a, b in zip(x, y, strict=True))
        return FieldBoundary(points, (0.9,) * 120, 0.96, 0.1, 0.4)


def _points(line: np.ndarray) -> tuple[tuple[float, float], ...]:
    return tuple((x, y) for x, y in line.round(1).tolist() if math.isfinite(x))


def _box(x: float, y: float, reach: float) -> tuple[int, int, int, int]:
    return round(x - reach), round(y - reach), round(x + reach), round(y + reach)


def _hypotheses(seen: Sightings) -> Hypotheses:
    robots = [
        Hypothesis(f"{r.team} robot", r.id, True, r.x_px, r.y_px, 18.0, _box(r.x_px, r.y_px, 5.0), r.confidence)
        for r in seen.robots
    ]
    balls = [
        Hypothesis("ball", None, True, b.x_px, b.y_px, 5.0, _box(b.x_px, b.y_px, 5.0), b.confidence) for b in seen.balls
    ]
    wrong = Hypothesis(
        "blue robot", None, False, *REJECTED_PX, 18.0, _box(*REJECTED_PX, 12.0), None,
        "of the wrong size (robots.min_area, robots.max_area)", "circle 24 px across", "9 to 18 px",
    )  # fmt: skip
    shown = (*robots, *balls, wrong)
    return Hypotheses(shown, len(shown))


def _blobs(hypotheses: Hypotheses) -> Blobs:
    shown = tuple(
        ShownBlob(h.what.split()[0] if h.what != "ball" else "orange", h.x_px, h.y_px, 80, h.box_px)
        for h in hypotheses.shown
    )
    return Blobs(shown, BLOBS)
