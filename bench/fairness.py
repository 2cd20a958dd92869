"""Impartiality over 100 000 frames for 10 clients of two teams, and how soon a biased order of sending is found.

Every client has a socket of its own on loopback. The fair frames are sent by the service's compiled loop as fast as
they go; the biased ones by a loop of this file that lets blue go first in one frame of TWENTY and is counted by the
service's record. Judged by the service's report.

Measured: chi-square of places (teams; the least likely robot), the share of pairs in which blue was first, the
difference of the teams' mean lags as a share of the spread of a frame's lags, and the verdict.
"""

import contextlib
import socket
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from app.web.fairness.verdict import Judgment
from app.web.reports.fairness import FairnessReport, fairness_report
from bench.runner import Row
from vision_core.clock import MonotonicClock
from vision_core.net.delivery import Batch, DeliveryTable
from vision_core.net.delivery_rows import DROPPED, SENT, new_rows
from vision_core.net.fairness import note_frame
from vision_core.net.udp import SendResult, SessionSocket, SharedSocket
from vision_core.protocol.options import PAPER_OPTIONS
from vision_core.types.fairness import robot_index
from vision_core.types.objects import Team

FRAMES = 100_000
PER_TEAM = 5
TWENTY = 20
LOOK_EVERY = 250
DATAGRAM = b"(see 20306.148 ((edge) " + b"w2c" * 360 + b") ((ball) 61 121 3))"
GOAL_SHARE, GOAL_P = 0.01, 0.001


@dataclass
class Scene:
    """Ten sessions and their clients."""

    table: DeliveryTable
    sessions: list[SessionSocket]
    clients: list[socket.socket]
    clock: MonotonicClock

    def drain(self) -> None:
        """Empty the clients' sockets."""
        for client in self.clients:
            with contextlib.suppress(BlockingIOError):
                client.recv(len(DATAGRAM))

    def report(self) -> FairnessReport:
        """As it is now."""
        return fairness_report(self.table.fairness.table[0])


def run(frames: int = FRAMES) -> list[Row]:
    """Fair and biased. frames: of each."""
    with _scene() as scene:
        batch = Batch.of([DATAGRAM] * len(scene.sessions))
        for _ in range(frames):
            scene.table.send(scene.clock.now(), batch)
            scene.drain()
        fair = scene.report()
    with _scene() as scene:
        found = _send_biased(scene, frames)
        biased = scene.report()
    rows = [*_rows("drawn by lot", fair, Judgment.IMPARTIAL), *_rows("blue first in 1 of 20", biased, Judgment.BIASED)]
    rows.append({"name": "blue first in 1 of 20: found after", "value": found, "unit": "frames"})
    return rows


@contextlib.contextmanager
def _scene() -> Iterator[Scene]:
    with contextlib.ExitStack() as stack:
        server = stack.enter_context(socket.socket(socket.AF_INET, socket.SOCK_DGRAM))
        server.bind(("127.0.0.1", 0))
        shared, clock = SharedSocket(server), MonotonicClock()
        robots = [robot_index(team, number) for team in Team for number in range(1, PER_TEAM + 1)]
        table = DeliveryTable(clock.now(), seed=1)
        table.replace(new_rows(len(robots)))
        clients, sessions = [], []
        for row, robot in enumerate(robots):
            client = stack.enter_context(socket.socket(socket.AF_INET, socket.SOCK_DGRAM))
            client.bind(("127.0.0.1", 0))
            client.setblocking(False)
            session = shared.open_session("127.0.0.1", (*client.getsockname(), 0))
            stack.callback(session.close)
            table.address(row, robot, session.fileno(), PAPER_OPTIONS)
            clients.append(client)
            sessions.append(session)
        yield Scene(table, sessions, clients, clock)


def _send_biased(scene: Scene, frames: int) -> int | None:
    """Send frames of which one in TWENTY has blue first; returns after how many the report finds it."""
    random, rows, found = np.random.default_rng(1), scene.table.rows, None
    for frame in range(1, frames + 1):
        order = random.permutation(len(rows))
        if frame % TWENTY == 0:
            order = order[np.argsort(order >= PER_TEAM, kind="stable")]
        at = scene.clock.now()
        for row in order.tolist():
            result = scene.sessions[row].send(DATAGRAM)
            rows[row]["sent_at"], rows[row]["result"] = (
                scene.clock.now(),
                SENT if result is SendResult.SENT else DROPPED,
            )
        note_frame(scene.table.fairness.table, rows, order, len(order), at)
        scene.drain()
        if found is None and frame % LOOK_EVERY == 0 and scene.report().verdict is Judgment.BIASED:
            found = frame
    return found


def _rows(name: str, report: FairnessReport, expected: Judgment) -> list[Row]:
    robot = min(report.robots, key=lambda robot: robot.p)
    places, lag, order = report.places, report.lag, report.order
    verdict: Row = {"goal": expected.value, "met": report.verdict is expected}
    likely, robot_likely, share = {}, {}, {}
    if expected is Judgment.IMPARTIAL:
        likely = {"goal": f"> {GOAL_P:g}", "met": places.p > GOAL_P}
        robot_likely = {"goal": f"> {GOAL_P:g}", "met": robot.p > GOAL_P}
        share = {"goal": f"< {100.0 * GOAL_SHARE:g} %", "met": abs(lag.share) < GOAL_SHARE}
    teams, alone = "chi-square of the teams' places", "chi-square, least likely robot"
    return [
        {"name": f"{name}: datagrams sent", "value": sum(team.sent for team in report.teams), "unit": ""},
        {"name": f"{name}: verdict", "value": report.verdict.value, **verdict},
        {"name": f"{name}: {teams}", "value": places.chi_square, "baseline": float(places.freedom)},
        {"name": f"{name}: its probability by lot", "value": places.p, **likely},
        {"name": f"{name}: {alone}", "value": robot.chi_square, "baseline": float(robot.freedom)},
        {"name": f"{name}: its probability, of ten robots", "value": robot.p, **robot_likely},
        {"name": f"{name}: pairs with blue first", "value": 100.0 * order.blue_first, "unit": "%", "baseline": 50.0},
        {"name": f"{name}: difference of the mean lags", "value": lag.difference_us, "unit": "us"},
        {"name": f"{name}: spread of a frame's lags", "value": lag.spread_us, "unit": "us"},
        {"name": f"{name}: difference over spread", "value": 100.0 * abs(lag.share), "unit": "%", **share},
    ]
