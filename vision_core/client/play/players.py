"""One robot's player: a connection, a controller, and what is counted of both. It runs in a thread of its own."""

import math
import threading
import time
from dataclasses import dataclass, replace

from vision_core.client.connecting import connect
from vision_core.client.connection import Connection
from vision_core.client.play.controllers import ControllerKind, options_of
from vision_core.client.view import View
from vision_core.clock import MS_PER_S
from vision_core.types.objects import Team

WAIT_S = 0.2
"""For a view, before it is looked whether the match is over."""
TIMEOUT_S = 10.0
"""For the answer to init."""


@dataclass(frozen=True, slots=True)
class Server:
    """Where the robots are."""

    host: str
    port: int
    key: str = ""


@dataclass(frozen=True, slots=True)
class PlayerCount:
    """What is counted of one player."""

    views: int = 0
    """That the controller was shown."""
    missed: int = 0
    """Images of the camera in between: lost, not sent, or too late for the controller."""
    age_s: float = 0.0
    """Sum of the ages of the views when the controller got them."""
    cpu_s: float = 0.0
    """Processor time of the thread: of the client and the controller."""

    @property
    def missed_share(self) -> float:
        """Missed images among all, 0..1."""
        return self.missed / max(self.views + self.missed, 1)

    @property
    def mean_age_ms(self) -> float:
        """Of the views, when the controller got them [ms]."""
        return self.age_s / max(self.views, 1) * MS_PER_S


class Player:
    """Plays one robot until it is stopped."""

    def __init__(self, server: Server, team: Team, number: int, kind: ControllerKind) -> None:
        self.team, self.number = team, number
        self.count = PlayerCount()
        self.is_connected = threading.Event()
        self._server = server
        self._kind = kind

    def play(self, stop: threading.Event) -> None:
        """Raises ConnectionRefused, and whatever the controller raises."""
        server, began_s = self._server, time.thread_time()
        with connect(
            server.host, server.port, self.team, self.number, options=options_of(self._kind), key=server.key,
            timeout_s=TIMEOUT_S,
        ) as connection:  # fmt: skip
            controller = self._kind(connection.robot)
            self.is_connected.set()
            last_s = None
            while not stop.is_set():
                view = connection.newest(WAIT_S)
                if view is not None:
                    connection.follow(controller.decide(view))
                    self._note(view, last_s, connection, began_s)
                    last_s = view.time_s

    def _note(self, view: View, last_s: float | None, connection: Connection, began_s: float) -> None:
        count, facts = self.count, connection.facts
        missed = 0
        if last_s is not None and facts is not None:
            missed = max(round((view.time_s - last_s) * MS_PER_S / facts.period_ms) - 1, 0)
        age_s = view.age_s if math.isfinite(view.age_s) else 0.0
        self.count = replace(
            count, views=count.views + 1, missed=count.missed + missed, age_s=count.age_s + age_s,
            cpu_s=time.thread_time() - began_s,
        )  # fmt: skip
