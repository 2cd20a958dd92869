"""The game of a simulated match: its score, as the simulation's truth has it. Where robots and ball are is not told."""

from app.web.blackboard import ServiceSnapshot
from app.web.reports.base import Report
from vision_core.rtdb import records
from vision_core.types.game import TeamGame
from vision_core.types.objects import Team


class TeamGameReport(Report):
    """One team's part of a game."""

    goals: int
    possession_s: float
    """How long a robot of the team was the last one that touched the ball [s]."""


class DrivenRobotReport(Report):
    """A robot that a client's program drives."""

    team: Team
    number: int
    silent: bool
    """Its program has sent no command for too long, so the robot stands."""


class GameReport(Report):
    """A game since it began."""

    played_s: float
    """Time of the simulation [s]."""
    blue: TeamGameReport
    yellow: TeamGameReport
    collisions: int
    """Contacts of two robots that have begun."""
    owner: Team | None
    """The team whose robot touched the ball last; null: nobody, since it was put down."""
    driven: list[DrivenRobotReport]


def game_from(snapshot: ServiceSnapshot) -> GameReport | None:
    """The game; None where the match is not simulated, or before the first image."""
    timed = snapshot.of(records.GAME)
    if timed is None:
        return None
    game = timed.value
    return GameReport(
        played_s=game.played_s,
        blue=_team(game.blue),
        yellow=_team(game.yellow),
        collisions=game.collisions,
        owner=game.owner,
        driven=[DrivenRobotReport(team=one.team, number=one.number, silent=one.silent) for one in game.driven],
    )


def _team(game: TeamGame) -> TeamGameReport:
    return TeamGameReport(goals=game.goals, possession_s=game.possession_s)
