"""Calibrations as jobs for a process of its own: what goes in."""

from typing import TypeAlias

from msgspec import Struct

from vision_core.calibration.mirror.fit import FocalPrior
from vision_core.calibration.mirror.pairs import SharedError
from vision_core.calibration.mirror.rounding import Rounding
from vision_core.settings.schema import Settings
from vision_core.types.objects import Team


class PictureFile(Struct, frozen=True):
    """One of the pictures to calibrate by."""

    path: str
    name: str
    """What messages call it."""


class CameraJob(Struct, frozen=True, tag=True):
    """Calibrate the camera by painted lines: a ``Calibration``. A lens that the settings have holds."""

    settings: Settings
    pictures: tuple[PictureFile, ...]
    corners_px: tuple[tuple[float, float], ...] | None
    """Outer corners of the field's lines: left top, right top, right bottom, left bottom. None: not given."""
    finds: bool
    """Search the field in the pictures. Otherwise, without corners, the camera of the settings is the first guess."""
    height_m: float | None
    """Of the camera, by tape measure."""
    swaps_ends: bool
    """The field's left end is the other one."""
    frees_measures: bool
    """The field's measures, except its length, are estimates: solve them too."""


class LensJob(Struct, frozen=True, tag=True):
    """Measure the lens by pictures of a board: a ``LensCalibration``."""

    pictures: tuple[PictureFile, ...]


class NamedPair(Struct, frozen=True):
    """A radius and a distance."""

    r_px: float
    r_mm: float
    name: str
    """What messages call it."""
    shared: SharedError = SharedError()


class PairsJob(Struct, frozen=True, tag=True):
    """Everything that stands around a robot in its on-board picture: ``FoundPairs``."""

    settings: Settings
    picture: PictureFile
    text: str
    """CSV of directions and distances; empty: the ceiling camera's picture says it."""
    ceiling: str
    """Path of the ceiling camera's picture of the same instant."""
    team: Team
    number: int
    """Of the robot in it."""
    center_px: tuple[float, float] | None
    """Of the mirror's image; None: the picture's middle."""
    scale: float
    """Pixels of the picture per pixel of equation 1."""


class FoundPairs(Struct, frozen=True):
    """The pairs that a picture shows."""

    pairs: tuple[NamedPair, ...]
    places_px: tuple[tuple[float, float], ...]
    """Of each in the picture."""


class Rim(Struct, frozen=True):
    """The circle of a mirror's rim [px of the picture]."""

    column: float
    row: float
    radius_px: float


class RimJob(Struct, frozen=True, tag=True):
    """The mirror's place in an on-board picture: a ``Rim``."""

    picture: PictureFile


class EdgeJob(Struct, frozen=True, tag=True):
    """The edge of a target in an on-board picture: a ``RadialEdge``."""

    picture: PictureFile
    center_px: tuple[float, float] | None
    place_px: tuple[float, float] | None
    """Near it, a click; None: the strongest edge in the direction."""
    direction_rad: float


class MirrorJob(Struct, frozen=True, tag=True):
    """Fit the mirror of the on-board cameras to pairs: a ``MirrorCalibration``."""

    settings: Settings
    """Their field is what the mirror has to resolve."""
    pairs: tuple[NamedPair, ...]
    rounding: Rounding
    prior: FocalPrior | None
    """Of the on-board camera; None: not known."""


ShortJob: TypeAlias = EdgeJob | RimJob
CalibrationJob: TypeAlias = CameraJob | LensJob | MirrorJob | PairsJob | ShortJob
