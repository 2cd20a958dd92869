"""The patterns that the robots of a team wear, by the settings."""

from collections.abc import Iterable, Mapping

import msgspec

from vision_core.errors import SettingsError
from vision_core.models.from_settings import robots_of
from vision_core.patterns.loader import load_pattern
from vision_core.patterns.pattern import Pattern
from vision_core.settings.schema import RobotSettings
from vision_core.types.objects import Team


def worn_patterns(robots: RobotSettings, team: Team) -> tuple[Pattern, ...]:
    """The patterns of a team, each with the ids that its robots wear.

    Raises SettingsError for a pattern that cannot be read, ids that it lacks, and ids that two patterns have.
    """
    own = robots_of(robots, team)
    names, chosen = own.patterns, own.pattern_ids
    if chosen and len(chosen) != len(names):
        found, accepted = f"{len(chosen)} lists for {len(names)} patterns", "a list of ids for each pattern"
        raise SettingsError(f"robots.{team}: pattern_ids", found=found, accepted=accepted)
    patterns = [load_pattern(name) for name in names]
    if chosen:
        patterns = [_with_ids(pattern, ids) for pattern, ids in zip(patterns, chosen, strict=True)]
    if len(patterns) > 1:
        _check_ids(team, patterns)
    return tuple(patterns)


def pattern_with_id(patterns: tuple[Pattern, ...], marker_id: int) -> Pattern | None:
    """Which of a team's patterns has an id; None: none."""
    return next((pattern for pattern in patterns if marker_id in pattern.code_by_id), None)


def patterns_by_team(robots: RobotSettings) -> dict[Team, tuple[Pattern, ...]]:
    """The patterns of both teams. Raises SettingsError as ``worn_patterns``."""
    return {team: worn_patterns(robots, team) for team in Team}


def colors_of(patterns: Mapping[Team, Iterable[Pattern]], *ball: str) -> tuple[str, ...]:
    """The color classes that ball and robots need, each once. ball: its classes, which come first."""
    colors = dict.fromkeys(ball)
    for team, worn in patterns.items():
        for pattern in worn:
            for number in pattern.code_by_id:
                colors |= dict.fromkeys(pattern.colors_worn(team, number))
    return tuple(colors)


def _with_ids(pattern: Pattern, ids: tuple[int, ...]) -> Pattern:
    known = pattern.code_by_id
    if unknown := [number for number in ids if number not in known]:
        raise SettingsError(
            f"robots.pattern_ids of pattern {pattern.name}",
            found=", ".join(map(str, unknown)),
            accepted=f"ids of the pattern: {', '.join(map(str, known))}",
        )
    if not ids:
        return pattern
    code = msgspec.structs.replace(pattern.code, ids={str(number): known[number] for number in ids})
    return msgspec.structs.replace(pattern, code=code)


def _check_ids(team: Team, patterns: list[Pattern]) -> None:
    """An id tells one robot: two patterns of a team share none."""
    owners: dict[int, Pattern] = {}
    for pattern in patterns:
        for number in pattern.code_by_id:
            if (other := owners.setdefault(number, pattern)) is not pattern:
                raise SettingsError(
                    f"robots.{team}: pattern",
                    found=f"{other.name} and {pattern.name} both have id {number}",
                    accepted="patterns of different ids, or robots.pattern_ids = [[ids of the first], [of the second]]",
                )
