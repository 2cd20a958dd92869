"""What the steps of setting up a venue find; nothing of it is in a draft before somebody takes it."""

from collections.abc import Sequence

import msgspec
import numpy as np
from msgspec import Struct

from vision_core.calibration.result import Calibration, LineResult
from vision_core.errors import SettingsError
from vision_core.settings.schema import LightSettings, SamplingSettings
from vision_core.setup.draft import NOTHING, Draft, DraftCamera
from vision_core.types.reasons import Reason


class Looked(Struct, frozen=True):
    """Size of a picture."""

    width_px: int
    height_px: int


class CameraTrial(Struct, frozen=True):
    """A camera that was found, or an attempt."""

    camera: DraftCamera | None
    """To be taken; None: it is refused."""
    measures_m: dict[str, float]
    """Measures of the field that were solved with it, by their names."""
    reasons: tuple[Reason, ...]
    """Why it is refused."""
    notes: tuple[str, ...]
    """What one should know although it is not refused."""
    lines: tuple[LineResult, ...]
    """Painted lines and, of walls, their feet, where the camera puts them."""
    height_m: float
    is_height_unknown: bool
    """Neither the lines nor a tape measure tell it."""
    calibration: Calibration | None
    """Of painted lines; None: from corners alone."""


class FieldTrial(Struct, frozen=True):
    """How well a preset explains the pictures."""

    preset: str
    camera: CameraTrial
    painted: float
    """Share of the preset's lines, by their length in the picture, that show paint at their places."""


class ClassMap(Struct, frozen=True):
    """The class of every pixel, and how much of the picture each class has."""

    pixels: bytes
    """PNG."""
    shares: dict[str, float]
    colors: dict[str, str]
    """In which each class is drawn, #rrggbb."""


class Sampled(Struct, frozen=True):
    """A color of a picture, as the venue's light would show it."""

    color: str
    """#rrggbb"""
    words: str
    """The color in the units of all color spaces."""


class Picked(Struct, frozen=True):
    """A color that was added to a class, and what the classes are with it."""

    sampled: Sampled
    classes: ClassMap


class PaintSeen(Struct, frozen=True):
    """The color of one paint that was found."""

    name: str
    color: str
    """#rrggbb"""
    patches: int
    """How many patches show it; 0: its name alone tells it."""


class ColorTrial(Struct, frozen=True):
    """Colors that were found without a name for any of them."""

    samples: dict[str, tuple[str, ...]]
    sampling: SamplingSettings
    light: LightSettings
    paints: tuple[PaintSeen, ...]
    robots: int
    """That are read with these colors, in all pictures."""
    with_id: int
    balls: int
    reasons: tuple[Reason, ...]
    """What is doubtful: papers that are too alike, paints that nobody wears."""
    is_accepted: bool
    """It is clear enough to be taken."""


class SeenRobot(Struct, frozen=True):
    """A robot that was found in a picture."""

    team: str
    id: int | None
    x_m: float
    y_m: float
    confidence: float


class PictureTrial(Struct, frozen=True):
    """What is seen in one picture."""

    robots: tuple[SeenRobot, ...]
    balls: int
    obstacles: int
    reasons: tuple[str, ...]
    overlay: str
    """Name of the overlay's file; empty without one."""
    error: str
    """Why the picture was not judged; empty when it was."""

    @property
    def read(self) -> int:
        """Robots whose id is read."""
        return sum(robot.id is not None for robot in self.robots)


class VenueTrial(Struct, frozen=True):
    """What is seen with a venue, picture by picture, and with the settings in use."""

    pictures: tuple[PictureTrial, ...]
    before: tuple[PictureTrial, ...]
    """With the settings in use; empty where they are of a camera with pictures of another size."""
    why_not_before: str
    """Why there is nothing to compare with; empty where there is."""


def taken(draft: Draft, trial: CameraTrial) -> Draft:
    """The draft with a camera, and with the measures of the field that were solved with it.

    Where nothing was sampled yet it begins with the colors of the floor. Raises SettingsError.
    """
    if trial.camera is None or draft.field is None:
        found = "; ".join(map(str, trial.reasons)) or "no camera"
        raise SettingsError("the camera", found=found, accepted="one that is not refused")
    measures = {name: round(value, 4) for name, value in trial.measures_m.items()}
    field = msgspec.structs.replace(draft.field, **measures)
    samples = draft.samples or {NOTHING: trial.camera.floor}
    return msgspec.structs.replace(draft, camera=trial.camera, field=field, samples=samples)


def with_colors(draft: Draft, trial: ColorTrial, *, takes_doubtful: bool = False) -> Draft:
    """The draft with colors that were found, in place of its samples.

    takes_doubtful: somebody has seen what is doubtful and wants them as a beginning; otherwise SettingsError is raised.
    """
    if not (trial.is_accepted or takes_doubtful):
        found = "; ".join(map(str, trial.reasons)) or "no robot that is read clearly"
        raise SettingsError("the colors", found=found, accepted="colors with which robots are read, or picked ones")
    return msgspec.structs.replace(draft, samples=trial.samples, sampling=trial.sampling, light=trial.light)


def painted_share(lines: Sequence[LineResult]) -> float:
    """Share of the visible lines, by length, that show paint at their places; 0 without lines."""
    lengths = np.array([_length_px(line) * line.visible for line in lines])
    found = np.array([line.found for line in lines])
    return float(lengths @ found / lengths.sum()) if lengths.sum() > 0.0 else 0.0


def _length_px(line: LineResult) -> float:
    path = np.array(line.points_px)
    steps = np.diff(path, axis=0) if len(path) > 1 else np.zeros((0, 2))
    length = np.hypot(*steps.T).sum() if len(steps) else 0.0
    return float(length) if np.isfinite(length) else 0.0
