"""Choices of a new venue: field, marker pattern, and the colors that both need."""

from collections.abc import Mapping

import msgspec

from vision_core.errors import SettingsError
from vision_core.patterns.loader import load_pattern
from vision_core.patterns.pattern import Pattern
from vision_core.patterns.worn import colors_of
from vision_core.setup.draft import MAX_SAMPLES, NOTHING, Draft
from vision_core.types.objects import Team
from vision_core.venues.presets import field_of, shipped

ALIKE = 24
"""Largest difference of a channel between nearly the same colors."""


def pattern_choices() -> dict[str, Pattern]:
    """The shipped patterns by the names of their files."""
    return {name: load_pattern(name) for name in shipped("patterns")}


def with_preset(draft: Draft, preset: str) -> Draft:
    """The draft with another field; a camera that was calibrated by the old one goes. Raises SettingsError."""
    field = field_of(preset)
    camera = draft.camera if draft.field == field else None
    return msgspec.structs.replace(draft, preset=preset, field=field, camera=camera)


def with_pattern(draft: Draft, name: str) -> Draft:
    """The draft with another pattern, and the size of the robots that the pattern is made for. Raises SettingsError."""
    robot = load_pattern(name).robot
    return msgspec.structs.replace(draft, pattern=name, robot_radius_m=robot.radius_m, robot_height_m=robot.height_m)


def needed_colors(draft: Draft) -> list[str]:
    """The classes that the ball and the markers need, the ball's first."""
    patterns = (load_pattern(draft.pattern),) if draft.pattern else ()
    return list(colors_of(dict.fromkeys(Team, patterns), draft.ball_color))


def missing_colors(draft: Draft) -> list[str]:
    """Those of them that have no sample yet."""
    return [color for color in needed_colors(draft) if not draft.samples.get(color)]


def with_sample(draft: Draft, name: str, color: str) -> Draft:
    """The draft with one more sample of a class; what is like it is no longer "none".

    Raises SettingsError for a class that nothing has, a sample of another one, or too many.
    """
    accepted = [*needed_colors(draft), NOTHING]
    if name not in accepted:
        raise SettingsError(f"color class {name}", found="nothing wears it", accepted=", ".join(accepted))
    samples: Mapping[str, tuple[str, ...]] = draft.samples
    for other, colors in samples.items():
        if other not in (name, NOTHING) and color in colors:
            raise SettingsError(f"{color} as {name}", found=f"a sample of {other}", accepted="each color in one class")
    own = tuple(dict.fromkeys((*samples.get(name, ()), color)))
    if len(own) > MAX_SAMPLES:
        raise SettingsError(f"samples of {name}", found=str(len(own)), accepted=f"at most {MAX_SAMPLES}")
    kept = tuple(each for each in samples.get(NOTHING, ()) if name == NOTHING or not _alike(each, color))
    none = {NOTHING: kept} if NOTHING in samples else {}
    return msgspec.structs.replace(draft, samples={**samples, **none, name: own})


def _alike(one: str, other: str) -> bool:
    """Are two colors "#rrggbb" nearly the same?"""
    levels = [[int(text[at : at + 2], 16) for at in (1, 3, 5)] for text in (one, other)]
    return all(abs(a - b) <= ALIKE for a, b in zip(*levels, strict=True))


def without_sample(draft: Draft, name: str, color: str) -> Draft:
    """The draft without a sample of a class."""
    left = {
        key: tuple(each for each in colors if (key, each) != (name, color)) for key, colors in draft.samples.items()
    }
    return msgspec.structs.replace(draft, samples={key: colors for key, colors in left.items() if colors})
