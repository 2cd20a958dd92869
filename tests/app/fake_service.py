"""A service without its tasks: fills the database with a plausible match, for the tests of the web part.

``python -m tests.app.fake_service --port 8100 --clients 10 --state ready`` serves the page on it, to look at.
"""

import argparse
import math
import shutil
import socket
import tempfile
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path

import httpx
import numpy as np
import uvicorn
from msgspec import to_builtins

from app.web.application import create_app
from app.web.auth.people import People
from app.web.server import server_config
from tests.app.fake_overlay import FakeOverlays
from tests.app.fake_picture import FakePicture, Pose
from tests.app.fake_tasks import (
    SPARES,
    Condition,
    adapted,
    clients_of,
    fairness_of_a_match,
    findings,
    lags_of,
    process_infos,
    self_test,
    task_info,
    timing_of,
)
from vision_core.clock import Instant, MonotonicClock, after
from vision_core.color.light import start_light
from vision_core.models.camera_setup import CameraSetup
from vision_core.models.from_settings import robots_of
from vision_core.pipeline.view_encoder import ViewEncoder
from vision_core.rtdb import records
from vision_core.rtdb.infos import Processes, ServiceInfo, Serving, SourceInfo, TaskOverride
from vision_core.rtdb.items import Item, T
from vision_core.rtdb.log_record import LOG, LogLevel, LogLine, ServiceLog
from vision_core.rtdb.store import Store, create_block
from vision_core.settings.layers import Layer, LayerKind
from vision_core.settings.schema import Settings
from vision_core.tasks.table import record_specs, task_table
from vision_core.types.game import DrivenRobot, Game, TeamGame
from vision_core.types.objects import (
    BallSighting,
    Diagnosis,
    Obstacles,
    ObstacleSighting,
    RobotSighting,
    Sightings,
    Team,
)
from vision_core.types.reasons import Reason
from vision_core.types.tables import WorldTable
from vision_core.types.tracks import BallTrack, ObstacleTrack, RobotTrack, World
from vision_core.venues.loader import layers_of, load_settings, settings_from_layers

CAMERA = "main"
OPTIONS = Layer("command line", {}, kind=LayerKind.OPTIONS)
OVERLAY_EVERY = 8
"""Frames between two overlays."""
OBSTACLES = ((0.05, 0.95, 0.11), (-0.1, -0.45, 0.06))
"""Shares of half the field's length and width, radius [m]."""


@dataclass
class Scene:
    """What the fake service pretends; change it while it runs."""

    clients: int = 10
    robots: bool = True
    unread: bool = False
    """Of the first robot neither id nor heading can be read."""
    missing: int = 0
    """The last robots, which no camera sees."""
    image: bool = True
    """Images come; without them everything after the camera is silent too."""
    states: dict[str, tuple[str, str]] = field(default_factory=dict)
    """State and detail of processes that do not run."""
    condition: Condition = field(default_factory=Condition)
    reasons: tuple[Reason, ...] = ()
    obstacles: bool = True
    moving: bool = True
    repeats: bool = False


GAME = Game(
    played_s=187.5,
    blue=TeamGame(goals=2, possession_s=90.0),
    yellow=TeamGame(goals=1, possession_s=30.0),
    collisions=25,
    owner=Team.BLUE,
    driven=(DrivenRobot(Team.BLUE, 1, silent=False), DrivenRobot(Team.YELLOW, 3, silent=True)),
)


class FakeService:
    """The database of a service, and what its tasks would write."""

    def __init__(self, scene: Scene | None = None, settings: Settings | None = None) -> None:
        self.scene = scene or Scene()
        layers = layers_of() if settings is None else [Layer("test", to_builtins(settings)), OPTIONS]
        self.settings = settings or settings_from_layers(layers)
        self.clock = MonotonicClock()
        self.tasks = task_table(self.settings)
        processes = dict.fromkeys(task.process for task in self.tasks)
        self.specs = record_specs(self.settings, self.tasks, (*processes, "compile", *SPARES))
        self.block = create_block(self.specs)
        self.store = Store(self.specs, self.block)
        self.boot = self.clock.now()
        self._live = self.store.reader(records.LIVE_SETTINGS.spec.name)
        self._looking = records.LOOKING.reader(self.store)
        self._overlays = FakeOverlays(self.settings)
        self._writers = {spec.name: self.store.writer(spec.name) for spec in self.specs}
        self._camera = CameraSetup.from_settings(self.settings).model
        self._picture = FakePicture(self.settings, self._things())
        self._encoder = ViewEncoder(self.settings, self.boot)
        self._encoder.write(WorldTable(), ())  # compiled now, so that nobody waits for it later
        self._stop = threading.Event()
        self._thread: threading.Thread | None = None
        self._frames = 0
        addresses = "http://127.0.0.1:8000", "127.0.0.1:6000, sessions 6001"
        self._folder = tempfile.mkdtemp()
        """Of what is changed on the page."""
        info = ServiceInfo(
            "0.1.0",
            self.boot,
            *addresses,
            self.settings,
            task_table(self.settings),
            layers=tuple(replace(layer, text="") for layer in layers),
            database=f"{self._folder}/venue.db",
        )
        self.people = Path(self._folder) / "people.db"
        people = People(self.people)
        self.operator = {"authorization": f"Bearer {people.new_token('tests')[1]}"}
        """Headers of a request of the operator."""
        people.close()
        self.put(records.SERVICE, info)
        self.put(records.SELF_TEST, self_test(self.scene.condition))
        self.put(LOG, ServiceLog(tuple(starting_lines()), 0, 0))

    def put(self, item: Item[T], value: T, measured: Instant | None = None) -> None:
        """Write a record."""
        now = self.clock.now()
        self._writers[item.spec.name].write(item.encode(value), now if measured is None else measured, now)

    def _put_bytes(self, record: str, value: bytes) -> None:
        now = self.clock.now()
        self._writers[record].write(value, now, now)

    def write_processes(self) -> None:
        """What the supervisor writes."""
        self.put(records.PROCESSES, Processes(process_infos(self.tasks, self.scene.states)))

    def write_tasks(self) -> None:
        """What every task says of itself; the page speaks for itself."""
        live = records.LIVE_SETTINGS.over_reader(self._live).read(self.clock.now())
        wishes = live.value.tasks if live else {}
        for task in self.tasks:
            if {task.name, task.process}.isdisjoint({"web", *self.scene.states, *self.scene.condition.silent}):
                wish = wishes.get(task.name, TaskOverride())
                self.put(records.task(task.name), task_info(task, wish, self._frames, self.scene.condition))
                self._put_bytes(records.timing(task.name).name, timing_of(task))

    def write_frame(self) -> None:
        """What the tasks write for one image."""
        t = (self.clock.now() - self.boot) / 1e9 if self.scene.moving else 0.0
        self._frames += 1
        poses = self._poses(t) if self.scene.robots else []
        ball = self._on_field(0.65 * math.sin(0.5 * t), 0.6 * math.cos(0.37 * t))
        pixels = self._picture.drawn(poses, ball)
        grabbed = self.clock.now()  # after drawing, which takes long on a loaded machine
        self._writers[f"frames/{CAMERA}"].write(pixels.tobytes(), grabbed, self.clock.now())
        source = SourceInfo("synthetic", "simulated ceiling camera", self.scene.repeats, 30.0)
        self.put(records.source(CAMERA), source)
        sightings = self._sightings(poses, ball, grabbed)
        self.put(records.sightings(CAMERA), sightings, grabbed)
        look = self._looking.read(self.clock.now())
        if look and look.value.until > self.clock.now() and self._frames % OVERLAY_EVERY == 0:
            self.put(records.overlay(CAMERA), self._overlays.drawn(look.value, sightings, pixels), grabbed)
        self.put(records.obstacles(CAMERA), self._obstacles(grabbed), grabbed)
        self.put(records.diagnosis(CAMERA), Diagnosis(CAMERA, self._frames, grabbed, self.scene.reasons), grabbed)
        live = records.LIVE_SETTINGS.over_reader(self._live).read(self.clock.now())
        held = live is not None and not live.value.adapt
        self.put(records.palette(CAMERA), adapted(grabbed, start_light(self.settings.colors.light), held=held), grabbed)
        for item, finding in findings(CAMERA, self._frames, grabbed):
            self.put(item, finding, grabbed)
        world = self._world(poses, ball, grabbed)
        self.put(records.WORLD, world, grabbed)
        self._encoder.write(WorldTable.of(world), ())
        self.put(records.VIEWS, self._encoder.views.record(), grabbed)
        clients = clients_of(
            self.scene.condition, self.scene.clients, self.settings.match.numbers, self._frames, self.boot
        )
        self.put(records.SERVING, Serving(clients, 12.4, 19.8, ()))
        self._put_bytes(records.LAG_HISTOGRAMS.name, lags_of(self.scene.condition))
        self._put_bytes(records.FAIRNESS_RECORD.name, fairness_of_a_match())
        self.put(records.GAME, GAME)

    def start(self) -> None:
        """Write thirty times a second, until ``stop``."""
        self._stop.clear()
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def stop(self) -> None:
        """Stop writing."""
        self._stop.set()
        if self._thread is not None:
            self._thread.join()
        shutil.rmtree(self._folder, ignore_errors=True)

    def _run(self) -> None:
        while not self._stop.wait(1.0 / 30.0):
            self.write_processes()
            if self._frames % 10 == 0 or not self.scene.image:
                self.write_tasks()
            if self.scene.image:
                self.write_frame()

    def _poses(self, t: float) -> list[Pose]:
        poses = []
        per_team = self.settings.match.numbers
        for index in range(2 * per_team - self.scene.missing):
            team = Team.BLUE if index < per_team else Team.YELLOW
            number = index % per_team + 1
            phase = 0.4 * t + index * math.tau * 0.3
            side = -0.4 if team is Team.BLUE else 0.4
            x, y = self._on_field(
                side + (0.18 + 0.057 * number) * math.cos(phase),
                (2 * number - per_team - 1) * 0.165 + 0.1 * math.sin(1.3 * phase),
            )
            poses.append((team, number, x, y, phase + 1.2))
        return poses

    def _on_field(self, x: float, y: float) -> tuple[float, float]:
        """A place [m], given in halves of the field's length and width."""
        return x * self.settings.field.length_m / 2.0, y * self.settings.field.width_m / 2.0

    def _sightings(self, poses: list[Pose], ball: tuple[float, float], grabbed: Instant) -> Sightings:
        robots = []
        for team, number, x, y, heading in poses:
            height = robots_of(self.settings.robots, team).height_m
            px, py = self._camera.pixel_from_field(np.array([[x, y]]), height)[0]
            robots.append(RobotSighting(team, number, float(px), float(py), x, y, heading, 0.93, 0.001, 0.01))
        if self.scene.unread:
            robots[0] = replace(robots[0], id=None, heading_rad=None)
        px, py = self._camera.pixel_from_field(np.array([ball]))[0]
        balls = (BallSighting(float(px), float(py), *ball, 0.88, 0.001),)
        return Sightings(CAMERA, self._frames, grabbed, after(grabbed, 0.006), tuple(robots), balls, complete=True)

    def _things(self) -> list[tuple[float, float, float]]:
        """Where obstacles stand and their radius [m]."""
        return [(*self._on_field(x, y), radius) for x, y, radius in OBSTACLES if self.scene.obstacles]

    def _obstacles(self, grabbed: Instant) -> Obstacles:
        things = []
        for x, y, radius in self._things():
            px, py = self._camera.pixel_from_field(np.array([[x, y]]))[0].tolist()
            things.append(ObstacleSighting(px, py, x, y, radius, 0.8))
        return Obstacles(CAMERA, self._frames, grabbed, tuple(things))

    def _world(self, poses: list[Pose], ball: tuple[float, float], grabbed: Instant) -> World:
        robots = tuple(
            RobotTrack(team, number, x, y, heading, 0.1, 0.2, 0.4, 0.001, 0.01, 0.93, grabbed)
            for team, number, x, y, heading in poses
        )
        if self.scene.unread:
            robots = (replace(robots[0], id=None, heading_rad=0.0, heading_sd_rad=1.8), *robots[1:])
        things = tuple(ObstacleTrack(x, y, 0.0, 0.0, radius, grabbed) for x, y, radius in self._things())
        return World(self._frames, grabbed, robots, BallTrack(*ball, 0.4, -0.2, 0.002, False, grabbed), things)


def starting_lines() -> Iterator[LogLine]:
    """What a service prints while it starts, and when a process is lost."""
    printed = (
        ("supervisor", LogLevel.INFO, "10 of 10 processes run"),
        ("perceive", LogLevel.WARNING, "SCHED_FIFO 45 is refused: no CAP_SYS_NICE, and ulimit -r is 0"),
        ("web", LogLevel.INFO, "ready"),
        ("diagnose", LogLevel.ERROR, "Traceback (most recent call last):"),
        ("diagnose", LogLevel.ERROR, "ZeroDivisionError: division by zero"),
        ("supervisor", LogLevel.WARNING, "diagnose ended with exit status 1: it is started again"),
    )
    for number, (process, level, text) in enumerate(printed, 1):
        yield LogLine(number, time.time(), level, process, text)


class PageServer:
    """The application on a fake service, on a real socket of this process."""

    def __init__(self, service: FakeService, port: int = 0) -> None:
        self._listener = socket.create_server(("127.0.0.1", port))
        self.address = f"127.0.0.1:{self._listener.getsockname()[1]}"
        self._server = uvicorn.Server(server_config(create_app(service.store)))
        self._thread = threading.Thread(target=self._server.run, args=([self._listener],), daemon=True)

    def start(self) -> None:
        """Serve; returns when it does."""
        self._thread.start()
        wait_for(lambda: self._server.started)

    def stop(self) -> None:
        """Stop serving; open pages are closed."""
        self._server.should_exit = True
        self._thread.join()


@contextmanager
def running_service(scene: Scene | None = None, settings: Settings | None = None) -> Iterator[FakeService]:
    """A fake service that runs until the end of the block."""
    service = FakeService(scene, settings)
    service.start()
    yield service
    service.stop()


@contextmanager
def served_page(service: FakeService, path: str = "/healthz") -> Iterator[str]:
    """Address of the page of a fake service, from when a path of it answers 200 until the end of the block."""
    server = PageServer(service)
    server.start()
    wait_for(lambda: httpx.get(f"http://{server.address}{path}").status_code == 200)
    yield server.address
    server.stop()


@contextmanager
def asked_by_operator(service: FakeService, timeout_s: float = 20.0) -> Iterator[httpx.Client]:
    """An operator's client of the API of a fake service, until the end of the block."""
    with (
        served_page(service) as address,
        httpx.Client(base_url=f"http://{address}/api/v1", headers=service.operator, timeout=timeout_s) as client,
    ):
        yield client


def wait_for(reached: Callable[[], object], patience_s: float = 20.0) -> None:
    """Wait until something is so. Raises AssertionError after the patience."""
    deadline = time.monotonic() + patience_s
    while not reached():
        assert time.monotonic() < deadline, "it did not happen"
        time.sleep(0.01)


STATES: dict[str, Scene] = {
    "ready": Scene(),
    "compiling": Scene(
        image=False,
        states={
            "compile": ("running", "3 of 7: label pixels"),
            "capture": ("waiting", ""),
            **dict.fromkeys(("source", "perceive", "obstacles", "watch", "diagnose", "serve"), ("waiting", "")),
        },
    ),
    "blind": Scene(image=False),
    "crashing": Scene(states={"perceive": ("disabled", "5 ends within a minute, the last with signal SIGSEGV")}),
    "unread": Scene(unread=True, missing=1),
    "empty": Scene(
        robots=False,
        reasons=(Reason("no blob is large enough to be a dot of a marker", "Check the pattern."),),
        repeats=True,
    ),
    "degraded": Scene(
        condition=Condition(rights=False, p99_us=3200.0, reporting=False),
        states={"watch": ("disabled", "5 ends within a minute, the last with signal SIGSEGV")},
    ),
    "slow": Scene(condition=Condition(camera_rate_hz=9.0)),
    "explained": Scene(
        missing=4,
        reasons=(
            Reason("the picture is overexposed: 31 % of the field's pixels are at 255", "Close the lens."),
            Reason("no blob of class yellow is as large as a dot: 41 px, accepted: 70 to 160", "Check the pattern."),
            Reason("painted lines lie 9 px beside where the camera model sees them", "Calibrate the camera."),
        ),
    ),
}


def main() -> None:
    """Serve the page on a fake service until interrupted."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--port", type=int, default=8100)
    parser.add_argument("--clients", type=int, default=10)
    parser.add_argument("--state", choices=sorted(STATES), default="ready")
    parser.add_argument("--preset")
    parser.add_argument("--venue")
    chosen = parser.parse_args()
    scene = replace(STATES[chosen.state], clients=chosen.clients)
    service = FakeService(scene, load_settings(chosen.venue, options={"field_preset": chosen.preset}))
    service.start()
    PageServer(service, chosen.port).start()
    threading.Event().wait()


if __name__ == "__main__":
    main()
