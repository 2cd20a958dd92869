"""``/api/v1/game``: the score of a simulated match."""

from http import HTTPStatus

from fastapi import APIRouter

from app.web.blackboard import Blackboard
from app.web.configuration.configuration import Configuration
from app.web.problems import REFUSED, RequestRefused
from app.web.reports.game import GameReport, game_from


def game_routes(blackboard: Blackboard, configuration: Configuration) -> APIRouter:
    """Score, possession, collisions, and which robots are driven by programs."""
    router = APIRouter(prefix="/api/v1", tags=["match"])

    def game_now() -> GameReport:
        report = game_from(blackboard.read())
        if report is None:
            raise RequestRefused(
                HTTPStatus.NOT_FOUND,
                "the game",
                found=f"source.uri = {blackboard.service.settings.source.uri}"[:80],
                accepted="a simulated match that has begun: pslv serve without a camera",
            )
        return report

    @router.get("/game", responses={404: REFUSED[404]})
    def game() -> GameReport:
        """Score, possession, collisions, and which robots are driven by programs, from the simulation's truth."""
        return game_now()

    @router.post("/game", responses=REFUSED, status_code=HTTPStatus.NO_CONTENT)
    def begin_game() -> None:
        """Begins a new game: counts anew and puts the ball down anew; the robots stay where they are."""
        game_now()
        configuration.begin_game()

    return router
