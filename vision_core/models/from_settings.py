"""Mirror and robots as the settings describe them."""

from vision_core.models.mirror import Mirror
from vision_core.settings.schema import MirrorSettings, RobotSettings, TeamRobotSettings
from vision_core.types.objects import Team


def mirror_of(mirrors: MirrorSettings, team: Team) -> Mirror:
    """A team's mirror: its own, or that of the field. Raises SettingsError when it is not allowed."""
    constants = (mirrors.blue if team is Team.BLUE else mirrors.yellow) or mirrors
    return Mirror(constants.a, constants.b, constants.c)


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
