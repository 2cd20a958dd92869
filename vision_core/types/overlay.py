"""What is drawn over a picture for people: what the stages make of one image, and why they reject something."""

from dataclasses import dataclass
from enum import StrEnum

from vision_core.clock import Instant
from vision_core.types.regions import BodyContour, FieldBoundary


class Layer(StrEnum):
    """A part of an overlay, which is computed only while somebody looks at it."""

    CLASSES = "classes"
    BLOBS = "blobs"
    HYPOTHESES = "hypotheses"
    LINES = "lines"
    BOUNDARY = "boundary"
    CONTOURS = "contours"


@dataclass(frozen=True, slots=True)
class Looking:
    """Until when somebody looks at an overlay, and at which layers."""

    until: Instant
    layers: tuple[Layer, ...]


@dataclass(frozen=True, slots=True)
class ClassColor:
    """One color class."""

    name: str
    bgr: tuple[int, int, int]
    """A typical color of it."""


@dataclass(frozen=True, slots=True)
class ClassPicture:
    """The color class of every n-th pixel of every n-th row."""

    step_px: int
    """n."""
    png: bytes
    """Grey levels that are numbers of classes: 0 is no class, k is ``colors[k - 1]``."""
    colors: tuple[ClassColor, ...]


@dataclass(frozen=True, slots=True)
class ShownBlob:
    """A connected region of one color class."""

    color: str
    x_px: float
    y_px: float
    area_px: int
    box_px: tuple[int, int, int, int]
    """Left, top, right, bottom, inclusive."""


@dataclass(frozen=True, slots=True)
class Blobs:
    """The largest blobs of an image."""

    shown: tuple[ShownBlob, ...]
    count: int
    """How many there are."""


@dataclass(frozen=True, slots=True)
class Hypothesis:
    """A blob that could be a robot's team patch or the ball: what it was taken for, or which gate stopped it."""

    what: str
    """"blue robot", "yellow robot", "ball"."""
    id: int | None
    """Marker id of an accepted robot; None where there is none."""
    is_accepted: bool
    x_px: float
    y_px: float
    radius_px: float
    """Of such a robot or ball at this place; 0 where the place is off the floor."""
    box_px: tuple[int, int, int, int]
    """Of the blob: left, top, right, bottom, inclusive."""
    confidence: float | None
    """0..1; None where an earlier gate stopped it."""
    gate: str = ""
    """The gate that stopped it, or what an accepted one lacks, as "too small (ball.min_area)"; empty: nothing."""
    found: str = ""
    accepted: str = ""
    """What the gate accepts."""


@dataclass(frozen=True, slots=True)
class Hypotheses:
    """The accepted ones, then those that came nearest."""

    shown: tuple[Hypothesis, ...]
    count: int
    """How many there are."""


@dataclass(frozen=True, slots=True)
class PaintedLine:
    """A painted line of the field where the camera model puts it, and whether paint is there."""

    points_px: tuple[tuple[float, float], ...]
    """Those in the picture."""
    is_found: bool
    offset_px: float | None
    """Distance of the seen line from its place; None where it was not found."""
    found: str = ""
    accepted: str = ""
    """Why it was not found: what there is, and what is accepted; empty where it was."""


@dataclass(frozen=True, slots=True)
class Overlay:
    """What the stages make of one image; a layer at which nobody looks is None."""

    camera: str
    frame_number: int
    grabbed: Instant
    classes: ClassPicture | None = None
    blobs: Blobs | None = None
    hypotheses: Hypotheses | None = None
    lines: tuple[PaintedLine, ...] | None = None
    boundary: FieldBoundary | None = None
    contours: tuple[BodyContour, ...] | None = None
