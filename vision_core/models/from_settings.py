"""Mirror and robots as the settings describe them."""

from vision_core.models.mirror import Mirror
from vision_core.settings.schema import MirrorSettings, RobotSettings, TeamRobotSettings
from vision_core.types.objects import Team
from vision_core.types.tables import MAX_NUMBERS


def mirror_of(mirrors: MirrorSettings, team: Team, number: int | None = None) -> Mirror:
    """The mirror of a robot: its own, or that of its team, or that of the field.

    number: None for the team's robots that have none of their own. Raises SettingsError when it is not allowed.
    """
    own = None if number is None else mirrors.robots.get(f"{team.value} {number}")
    constants = own or (mirrors.blue if team is Team.BLUE else mirrors.yellow) or mirrors
    return Mirror(constants.a, constants.b, constants.c)


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
