"""Mirror and robots as the settings describe them."""

from collections.abc import Iterator

from vision_core.models.mirror import Mirror
from vision_core.settings.schema import MirrorConstants, MirrorSettings, RobotSettings, TeamRobotSettings
from vision_core.types.objects import Team
from vision_core.types.tables import MAX_NUMBERS

FIELD = "field"
"""The scope of all robots."""


def scope_of(team: Team | None, number: int | None = None) -> str:
    """What the settings call a robot, or the robots of a team; None: all of the field."""
    if team is None:
        return FIELD
    return team.value if number is None else f"{team.value} {number}"


def given_mirrors(
    mirrors: MirrorSettings, team: Team | None, number: int | None = None
) -> Iterator[tuple[str, MirrorConstants]]:
    """The scopes that have a mirror for a robot, with it: the robot itself, its team, the field. The first counts.

    team, number: None as of ``scope_of``.
    """
    of_team = None if team is None else mirrors.blue if team is Team.BLUE else mirrors.yellow
    scope = scope_of(team, number)
    for name, own in ((scope, mirrors.robots.get(scope)), (scope_of(team), of_team), (FIELD, mirrors)):
        if own is not None:
            yield name, own


def mirror_from(constants: MirrorConstants) -> Mirror:
    """The mirror of some constants. Raises SettingsError when it is not allowed."""
    return Mirror(constants.a, constants.b, constants.c)


def mirror_of(mirrors: MirrorSettings, team: Team | None, number: int | None = None) -> Mirror:
    """The mirror of a robot: its own, or that of its team, or that of the field.

    number: None for the team's robots that have none of their own; team: None for those of the field. Raises
    SettingsError when it is not allowed.
    """
    _, constants = next(given_mirrors(mirrors, team, number))
    return mirror_from(constants)


def mirrors_of(mirrors: MirrorSettings) -> dict[tuple[Team, int], Mirror]:
    """The mirror of every robot that may play. Raises SettingsError when one is not allowed."""
    return {(team, number): mirror_of(mirrors, team, number) for team in Team for number in range(1, MAX_NUMBERS + 1)}


def robots_of(robots: RobotSettings, team: Team) -> TeamRobotSettings:
    """Pattern, outline, size and marker height of a team's robots: its own settings, or those of both teams."""
    own = robots.blue if team is Team.BLUE else robots.yellow
    return own or TeamRobotSettings(
        pattern=robots.pattern,
        pattern_ids=robots.pattern_ids,
        outline=robots.outline,
        radius_m=robots.radius_m,
        height_m=robots.height_m,
    )
