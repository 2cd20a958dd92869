"""The game of a simulated match, as its truth has it."""

from dataclasses import dataclass

from vision_core.types.objects import Team


@dataclass(frozen=True, slots=True)
class TeamGame:
    """One team's part of a game."""

    goals: int
    possession_s: float
    """How long a robot of the team was the last one that touched the ball."""


@dataclass(frozen=True, slots=True)
class DrivenRobot:
    """A robot that a client's program drives."""

    team: Team
    number: int
    silent: bool
    """Its program has sent no command for too long, so the robot stands."""


@dataclass(frozen=True, slots=True)
class Game:
    """A game since it began."""

    played_s: float
    """Time of the simulation."""
    blue: TeamGame
    yellow: TeamGame
    collisions: int
    """Contacts of two robots that have begun."""
    owner: Team | None
    """The team whose robot touched the ball last; None: nobody, since it was put down."""
    driven: tuple[DrivenRobot, ...] = ()
