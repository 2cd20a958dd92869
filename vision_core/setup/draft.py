"""What is known of a new venue so far."""

from typing import Annotated, Literal

import msgspec
from msgspec import Meta

from vision_core.settings.schema import (
    FieldSettings,
    HexColor,
    HomographySettings,
    Level,
    LightSettings,
    PinholeSettings,
    Record,
    SamplingSettings,
)

NAME = r"^[a-z0-9][a-z0-9_-]{0,39}$"
MAX_PICTURES = 32
MAX_SAMPLES = 256
"""Of a color class."""
NOTHING = "none"
"""The class of colors that must not be found."""
VenueName = Annotated[str, Meta(pattern=NAME, description="small letters, digits, - and _; the name of its file")]
Samples = Annotated[tuple[HexColor, ...], Meta(max_length=MAX_SAMPLES)]


class DraftPicture(Record, frozen=True):
    """One picture of the venue."""

    file: str
    """Its name in the draft's folder."""
    name: str
    """As it was given."""
    width_px: int
    height_px: int


class DraftCamera(Record, frozen=True):
    """A camera that was calibrated and taken."""

    model: Literal["pinhole", "homography"]
    size_px: tuple[int, int]
    """Width and height of its pictures."""
    how: str
    """How it was made, for a comment."""
    reference_bgr: tuple[Level, Level, Level]
    """Mean color of the carpet in the first picture [grey levels]."""
    floor: tuple[HexColor, ...] = ()
    """Colors of the first picture that are no paper's: floor, lines, bodies."""
    pinhole: PinholeSettings | None = None
    homography: HomographySettings | None = None


class Draft(Record, frozen=True):
    """A venue that is being set up; what is empty or None is not known yet."""

    name: VenueName = "my-venue"
    about: Annotated[str, Meta(max_length=200)] = ""
    """A sentence about the venue, for the head of its file."""
    source: Annotated[str, Meta(max_length=400)] = ""
    """``source.uri`` of the venue; "pictures": the given ones are played; empty: the file names none."""
    pictures: Annotated[tuple[DraftPicture, ...], Meta(max_length=MAX_PICTURES)] = ()
    preset: str = ""
    """Name of the field's preset, whose measures ``field`` has unless they were edited."""
    field: FieldSettings | None = None
    camera: DraftCamera | None = None
    pattern: str = ""
    """Name of the markers' pattern in config/patterns."""
    robot_radius_m: Annotated[float, Meta(gt=0.005, le=1.0)] = 0.09
    robot_height_m: Annotated[float, Meta(ge=0.0, le=2.0)] = 0.14
    numbers: Annotated[int, Meta(ge=1, le=16)] = 5
    """Robots per team."""
    ball_color: Annotated[str, Meta(pattern="^[A-Za-z][A-Za-z0-9_-]{0,31}$")] = "orange"
    ball_radius_m: Annotated[float, Meta(gt=0.002, le=0.5)] = 0.02135
    samples: dict[str, Samples] = msgspec.field(default_factory=dict)
    """Measured colors by class; "none": what must not be found."""
    sampling: SamplingSettings | None = None
    """How near colors must be to the samples, as it was found with them; None: as usual."""
    light: LightSettings | None = None
    """The light of the samples, as it was found with them; None: that of the first picture, by the carpet."""

    @property
    def size_px(self) -> tuple[int, int] | None:
        """Width and height of all pictures; None before the first."""
        return (self.pictures[0].width_px, self.pictures[0].height_px) if self.pictures else None
