"""What happens in the simulated match, counted from its truth: goals, possession, collisions."""

from collections.abc import Sequence

from vision_core.capture.synthetic.bodies import NOBODY, new_tally
from vision_core.types.game import Game, TeamGame
from vision_core.types.objects import Team


class GameCount:
    """Counts one game. The team whose robot touched the ball last possesses it."""

    def __init__(self, teams: Sequence[Team]) -> None:
        """teams: of each robot."""
        self._teams = teams
        self.tally = new_tally(len(teams))
        self.begin()

    def begin(self) -> None:
        """A new game: nothing has happened."""
        self._goals = dict.fromkeys(Team, 0)
        self._possession_s = dict.fromkeys(Team, 0.0)
        self._played_s = 0.0
        self.tally.collisions[0] = 0
        self.lose_ball()

    def lose_ball(self) -> None:
        """The referee has put the ball down: nobody has touched it."""
        self.tally.touched[0] = NOBODY

    def score(self, team: Team) -> None:
        """The ball is in the goal that a team attacks."""
        self._goals[team] += 1

    def pass_time(self, duration_s: float) -> None:
        """Let time of the game pass."""
        self._played_s += duration_s
        if (owner := self._owner) is not None:
            self._possession_s[owner] += duration_s

    @property
    def _owner(self) -> Team | None:
        robot = int(self.tally.touched[0])
        return None if robot == NOBODY else self._teams[robot]

    def report(self) -> Game:
        """The game so far."""
        blue, yellow = (TeamGame(self._goals[team], self._possession_s[team]) for team in (Team.BLUE, Team.YELLOW))
        return Game(self._played_s, blue, yellow, int(self.tally.collisions[0]), self._owner)
