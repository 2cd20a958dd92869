"""What light and colors became since the set-up, how far they may go, and a log of the last changes."""

from app.web.blackboard import ServiceSnapshot
from app.web.reports.base import Report
from vision_core.clock import seconds_between
from vision_core.rtdb import records

Gains = tuple[float, float, float]
"""Of blue, green and red."""


class LightInForce(Report):
    """How pictures are converted to the light of the set-up: (level - black) * gain."""

    gain_bgr: Gains
    set_up_gain_bgr: Gains
    """Of the pictures of the set-up."""
    black_bgr: Gains
    max_gain: float
    """Light that needs a gain over this, or under its inverse, is not followed."""
    is_measured: bool
    """false: the venue has no reference of its light, so that gains stay those of the set-up."""
    reason: str
    """Why the light cannot be measured just now; empty when it can."""


class AdaptationChange(Report):
    """One change of the colors or the light in force."""

    age_s: float
    what: str
    """light: other gains; learned: the palette, from the robots that were still read; found: the palette anew, from
    nothing; start: the settings' palette again; held: back to the set-up; resumed: this was undone."""
    gain_bgr: Gains
    """In force from then on."""
    robots: int
    """Seen with a new palette in the picture that led to it."""
    read: int
    """Of these, read."""


class PaintShiftReport(Report):
    """How a paint looks now, beside how the settings have it: log B/G and log R/G."""

    name: str
    set_up: tuple[float, float]
    now: tuple[float, float]
    patches: int
    """From which it was learned; 0: placed by its name."""


class Adaptation(Report):
    """The light and the colors that the service sees with while they follow the light."""

    held: bool
    """The colors of the set-up are held: the live setting colors.light.adapt is false."""
    as_set_up: bool
    """Are gains and palette those of the settings?"""
    light: LightInForce
    paints: list[PaintShiftReport]
    """Empty while the settings' palette is in force."""
    max_shift: float
    """How far a paint may get from where it was set up, in each coordinate."""
    changes: list[AdaptationChange]
    """The last ones, oldest first."""


def adaptation_from(snapshot: ServiceSnapshot) -> Adaptation | None:
    """What is in force; None before the task follow has run."""
    timed = snapshot.of(records.palette)
    if timed is None:
        return None
    palette, settings = timed.value, snapshot.service.settings.colors.light
    light = palette.light
    return Adaptation(
        held=palette.held,
        as_set_up=not palette.paints and light.gain_bgr == settings.gain_bgr,
        light=LightInForce(
            gain_bgr=light.gain_bgr,
            set_up_gain_bgr=settings.gain_bgr,
            black_bgr=light.black_bgr,
            max_gain=settings.max_gain,
            is_measured=settings.reference_bgr is not None,
            reason=str(light.reason or ""),
        ),
        paints=[
            PaintShiftReport(name=one.name, set_up=one.set_up, now=one.now, patches=one.patches)
            for one in palette.paints
        ],
        max_shift=settings.max_shift,
        changes=[
            AdaptationChange(
                age_s=seconds_between(one.at, snapshot.now),
                what=one.what,
                gain_bgr=one.light.gain_bgr,
                robots=one.robots,
                read=one.read,
            )
            for one in palette.changes
        ],
    )
