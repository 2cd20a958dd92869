"""The steps of setting up a venue as jobs for a process of its own; ``run`` does them."""

from typing import Literal, TypeAlias

from msgspec import Struct

from vision_core.settings.schema import Settings
from vision_core.setup.draft import Draft

Begin = Literal["find", "corners", "walls"]
Corners = tuple[tuple[float, float], tuple[float, float], tuple[float, float], tuple[float, float]]


class CameraWish(Struct, frozen=True):
    """How a camera is to be found."""

    begin: Begin
    """find: search the painted lines; corners: painted lines, beginning with these corners; walls: corners alone."""
    corners_px: Corners | None = None
    """Left top, right top, right bottom, left bottom: of the lines' outer edges, or of the walls' feet."""
    height_m: float | None = None
    """Of the camera, by tape measure."""
    swaps_ends: bool = False
    frees_measures: bool = False
    """The field's measures, except its length, are estimates: solve them too."""


class Look(Struct, frozen=True, tag=True):
    """Can a picture be used, and how large is it? It finds a ``Looked``."""

    picture: str
    """Path of its file."""
    name: str
    """What a message calls it."""
    size_px: tuple[int, int] | None
    """That it must have; None: any."""
    needs_color: bool
    """A gray picture is refused, and a raw one."""


class Show(Struct, frozen=True, tag=True):
    """A picture as a browser shows it, whatever its file is: the bytes of a JPEG."""

    picture: str
    width_px: int
    """Of the shown one; a narrower picture stays as it is."""


class Recognize(Struct, frozen=True, tag=True):
    """Which preset is the field? It finds ``FieldTrial``s, the best first."""

    pictures: tuple[str, ...]
    marker_height_m: float
    height_m: float | None
    """Of the camera, by tape measure."""


class FindCamera(Struct, frozen=True, tag=True):
    """Lens and pose of the camera: a ``CameraTrial``."""

    draft: Draft
    pictures: tuple[str, ...]
    wish: CameraWish


class FindColors(Struct, frozen=True, tag=True):
    """The colors of markers and ball, by themselves: a ``ColorTrial``."""

    draft: Draft
    pictures: tuple[str, ...]


class Pick(Struct, frozen=True, tag=True):
    """A color of a picture for a class: a ``Picked``."""

    draft: Draft
    picture: str
    place_px: tuple[int, int]
    radius_px: int
    name: str
    """Of the class."""


class MapClasses(Struct, frozen=True, tag=True):
    """The class of every pixel: a ``ClassMap``."""

    draft: Draft
    picture: str


class Try(Struct, frozen=True, tag=True):
    """What is seen with the venue: a ``VenueTrial``."""

    draft: Draft
    pictures: tuple[str, ...]
    in_use: Settings | None
    folder: str
    """For overlays."""


SetupJob: TypeAlias = Look | Show | Recognize | FindCamera | FindColors | Pick | MapClasses | Try
