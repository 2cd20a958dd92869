"""Changes while programs of both teams are connected, mirror and match: at one frame for all, and no frame is lost."""

import itertools
import os
import socket
from collections.abc import Iterator
from contextlib import ExitStack
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import pytest

from app.web.configuration.configuration import Configuration
from app.web.configuration.keys import setting
from app.web.storage.document import Document
from tests.app.fake_service import FakeService, Scene
from vision_core.clock import Instant
from vision_core.models.camera_setup import CameraSetup
from vision_core.models.mirror import PAPER_MIRROR, Mirror
from vision_core.net.udp import open_server_sockets
from vision_core.protocol.answers import decode_message
from vision_core.protocol.encoding import encode
from vision_core.protocol.messages import (
    ErrorReply,
    Init,
    MirrorQuery,
    MirrorReply,
    MonitorInit,
    MonitorReply,
    See,
    WarningReply,
)
from vision_core.protocol.options import Options
from vision_core.protocol.proofs import Proof
from vision_core.rtdb import records
from vision_core.scheduling.attachment import Attachment, ChildResources
from vision_core.scheduling.handle import Handle
from vision_core.scheduling.releases import Release
from vision_core.tasks.serve import ServeTask
from vision_core.types.objects import RobotSighting, Sightings, Team

OTHER = Mirror(5.2, 0.0165, 90000.0)
ROBOTS = [(team, number) for team in Team for number in range(1, 6)]
ASKED = Options(time="us")


@dataclass
class Program:
    """A robot's program: what it was sent."""

    team: Team
    number: int
    socket: socket.socket

    def received(self) -> list[Any]:
        """The messages that have arrived."""
        found = []
        while True:
            try:
                found.append(decode_message(self.socket.recv(4096)))
            except BlockingIOError:
                return found


class Rig:
    """The task ``serve`` without its process, ten programs, and the configuration that the page changes."""

    def __init__(self, folder: Path, stack: ExitStack) -> None:
        self.service = service = FakeService(Scene(clients=0))
        stack.callback(service.stop)
        sockets = open_server_sockets("127.0.0.1", 0, 0)
        self.address = sockets[0].getsockname()
        descriptors = dict(zip(("main", "session"), (each.detach() for each in sockets), strict=True))
        attachment = Attachment(
            ChildResources("serve", os.getpid(), service.boot, service.block, service.specs, None, {}, descriptors)
        )
        (task,) = (task for task in service.tasks if task.name == "serve")
        camera = CameraSetup.from_settings(service.settings)
        self.task = ServeTask(Handle(task, attachment, service.settings, camera))
        stack.callback(self.task.server.close)
        for shared in self.task.server._shared.values():
            stack.callback(shared.socket.close)
        document = Document(folder / "venue.db")
        stack.callback(document.close)
        info = records.SERVICE.reader(service.store).read(service.clock.now())
        assert info is not None
        self.configuration = Configuration(service.store, info.value, document)
        self.programs = [Program(*robot, stack.enter_context(_socket())) for robot in ROBOTS]
        for program in self.programs:
            program.socket.sendto(encode(Init(program.team, program.number, ASKED)), self.address)
        for _ in ROBOTS:  # more inits at once than strangers have time for between two frames
            self.task.receive()
            self.task.server.expire()
        assert [len(program.received()) for program in self.programs] == [1] * len(ROBOTS)
        self.number = 0
        self.told: dict[tuple[Team, int], list[object]] = {}
        """What each program heard before the last frame's view."""

    def begin_match(self, admitted: list[str]) -> None:
        """Match mode, with these addresses admitted."""
        wanted = {setting("match.mode"): "match", setting("admission.subnets"): admitted}
        self.configuration.change(wanted, who="Ada", what="match")

    def frame(self) -> dict[tuple[Team, int], See]:
        """What every program is sent for a frame in which all robots stand where they stood before."""
        now = self.sight()
        views = {}
        for program in self.programs:
            *self.told[program.team, program.number], see = program.received()
            assert isinstance(see, See)
            assert see.time_us == (now - self.service.boot) // 1000
            views[program.team, program.number] = see
        return views

    def sight(self) -> Instant:
        """Serve a frame; returns its grab."""
        self.number += 1
        now = self.service.clock.now()
        sightings = Sightings("main", self.number, now, now, tuple(self._robots()), (), complete=True)
        self.service.put(records.sightings("main"), sightings, now)
        assert self.task.serve_newest(Release(now, now)).ran
        return now

    def mirrors_told(self) -> dict[tuple[Team, int], Mirror]:
        """What every program is answered when it asks for its mirror."""
        told = {}
        for program in self.programs:
            program.socket.sendto(encode(MirrorQuery()), self.address)
        self.task.receive()
        for program in self.programs:
            (reply,) = program.received()
            assert isinstance(reply, MirrorReply)
            told[program.team, program.number] = reply.mirror
        return told

    def _robots(self) -> Iterator[RobotSighting]:
        match = self.service.settings.match
        for team, number in ROBOTS:
            ids = match.blue_ids if team is Team.BLUE else match.yellow_ids
            x_m = (-1.0 if team is Team.BLUE else 1.0) * (0.2 + 0.15 * number)
            y_m = 0.3 * (number - 3)
            yield RobotSighting(team, ids[number - 1], 0.0, 0.0, x_m, y_m, 0.3 * number, 1.0, 0.001, 0.01)


def _socket() -> socket.socket:
    program = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    program.bind(("127.0.0.1", 0))
    program.setblocking(False)
    return program


@pytest.fixture
def rig(tmp_path: Path) -> Iterator[Rig]:
    with ExitStack() as stack:
        yield Rig(tmp_path, stack)


def edges(views: dict[tuple[Team, int], See]) -> dict[tuple[Team, int], bytes]:
    return {robot: see.edges for robot, see in views.items()}


def through(view: bytes, mirror: Mirror) -> list[int]:
    """Pixels of a view that was made through PAPER_MIRROR, through another one: no farther off than its own pixel."""
    px = [int(view[at + 1 : at + 3], 16) for at in range(0, len(view), 3)]
    return [int(mirror.px_from_mm(PAPER_MIRROR.mm_from_px(radius + 0.5))) for radius in px]


@pytest.mark.parametrize(
    ("key", "changed"),
    [
        ("mirror.blue", {robot for robot in ROBOTS if robot[0] is Team.BLUE}),
        ("mirror.robots.yellow 4", {(Team.YELLOW, 4)}),
    ],
)
def test_a_mirror_changes_at_one_frame_for_its_robots_alone_and_back(
    rig: Rig, key: str, changed: set[tuple[Team, int]]
) -> None:
    """Ten programs, five a team; robots stand still, so that a view changes with the mirror only."""
    sent = [edges(rig.frame()) for _ in range(5)]
    before = sent[-1]
    assert all(views == before for views in sent)
    value = {"a": OTHER.a, "b": OTHER.b, "c": OTHER.c}
    made = rig.configuration.change({setting(key): value}, who="Ada", what=key)
    assert made is not None
    after = edges(rig.frame())  # the first frame that is grabbed after the change is wholly made with it
    assert {robot for robot in ROBOTS if after[robot] != before[robot]} == changed
    for robot in changed:
        px = [int(after[robot][at + 1 : at + 3], 16) for at in range(0, len(after[robot]), 3)]
        off = max(abs(one - other) for one, other in zip(px, through(before[robot], OTHER), strict=True))
        assert off <= 2, "half a pixel of the one mirror, and the other's steps"
    assert all(edges(rig.frame()) == after for _ in range(5))
    told = rig.mirrors_told()
    assert {robot for robot, mirror in told.items() if mirror == OTHER} == changed
    assert {mirror for robot, mirror in told.items() if robot not in changed} == {PAPER_MIRROR}
    rig.configuration.undo(who="Ada", seen=made.revision)
    assert edges(rig.frame()) == before
    assert set(rig.mirrors_told().values()) == {PAPER_MIRROR}


def test_a_match_takes_away_the_mirror_that_a_program_asked_for(rig: Rig) -> None:
    before = edges(rig.frame())
    asking = rig.programs[2]
    own = replace(ASKED, mirror=OTHER)
    asking.socket.sendto(encode(Init(asking.team, asking.number, own)), rig.address)
    rig.task.receive()
    assert len(asking.received()) == 1
    assert {robot for robot, view in edges(rig.frame()).items() if view != before[robot]} == {(Team.BLUE, 3)}
    rig.begin_match(admitted=["127.0.0.1"])
    assert edges(rig.frame()) == before
    assert rig.told[asking.team, asking.number] == [WarningReply("fixed_by_match")]


def test_in_a_match_nobody_is_admitted_for_being_on_this_computer(rig: Rig) -> None:
    rig.frame()
    rig.begin_match(admitted=[])
    rig.sight()
    assert [program.received() for program in rig.programs] == [[ErrorReply("not_admitted")]] * len(ROBOTS)


def test_a_monitor_is_sent_the_whole_field_and_in_a_match_no_longer(rig: Rig) -> None:
    with _socket() as monitor:
        program = Program(Team.BLUE, 0, monitor)
        monitor.sendto(encode(MonitorInit()), rig.address)
        rig.task.receive()
        (challenge,) = program.received()
        monitor.sendto(encode(MonitorInit(Proof(challenge.cookie))), rig.address)
        rig.task.receive()
        assert [type(message) for message in program.received()] == [MonitorReply]
        views = rig.frame()
        (shown,) = program.received()
        assert {(robot.team, robot.number) for robot in shown.robots} == set(ROBOTS)
        assert {see.time_us // 1000 for see in views.values()} == {shown.time_us // 1000}
        blue_1 = next(robot for robot in shown.robots if (robot.team, robot.number) == (Team.BLUE, 1))
        assert (blue_1.x_mm, blue_1.y_mm) == (-350, -600)
        rig.begin_match(admitted=["127.0.0.1"])
        rig.frame()
        assert program.received() == [ErrorReply("not_admitted")]


def test_a_rehearsal_sends_nothing_and_leaves_no_trace(rig: Rig) -> None:
    def state() -> tuple[bytes, bytes, bytes]:
        server = rig.task.server
        return server.snapshot(), server.fairness.table.tobytes(), rig.task._tracker._state.tobytes()

    assert not rig.task.rehearse(lambda: False)  # there was no frame yet
    for _ in range(5):
        views = rig.frame()
        before, texts = state(), bytes(rig.task._encoder.text.text)
        for stages in range(4):
            answers = itertools.chain(itertools.repeat(False, stages), itertools.repeat(True))
            assert rig.task.rehearse(lambda answers=answers: next(answers)) == (stages == 3)  # type: ignore[misc]
        assert rig.task.rehearse(lambda: False)
        assert state() == before
        assert bytes(rig.task._encoder.text.text) == texts, "the same views are written again"
        assert [program.received() for program in rig.programs] == [[]] * len(ROBOTS)
    assert len(views) == len(ROBOTS)
