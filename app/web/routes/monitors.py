"""``/api/v1/monitors``: programs that are sent the whole field over UDP, and their key."""

from http import HTTPStatus

from fastapi import APIRouter

from app.web.auth.team_keys import MONITORS, TeamKeys
from app.web.blackboard import Blackboard
from app.web.configuration.configuration import Configuration
from app.web.problems import REFUSED
from app.web.reports.base import Report
from app.web.routes.teams import NewKey
from vision_core.rtdb import records


class MonitorsReport(Report):
    """The monitors, and whether there is a key for them."""

    has_key: bool
    """During a match a monitor needs the key; in practice it needs none."""
    connected: list[str]
    """Addresses with their ports."""


def monitor_routes(blackboard: Blackboard, configuration: Configuration, keys: TeamKeys) -> APIRouter:
    """The monitors."""
    router = APIRouter(prefix="/api/v1/monitors", tags=["clients"])

    @router.get("")
    def monitors() -> MonitorsReport:
        """Who is sent the whole field, and whether there is a key for it."""
        serving = blackboard.read().recent(records.SERVING)
        connected = serving.value.monitors if serving else ()
        return MonitorsReport(has_key=keys.digest_of(MONITORS) is not None, connected=list(connected))

    @router.post("/key", responses=REFUSED)
    def new_key() -> NewKey:
        """Makes a new key for monitors; the former one is no longer accepted."""
        key = keys.renew(MONITORS)
        configuration.publish()
        return NewKey(key=key)

    @router.delete("/key", responses=REFUSED, status_code=HTTPStatus.NO_CONTENT)
    def withdraw() -> None:
        """Withdraws the key: during a match no monitor sees the field."""
        keys.forget(MONITORS)
        configuration.publish()

    return router
