"""A service without its tasks: fills the database with a plausible match, for the tests of the web part.

``python -m tests.app.fake_service --port 8100 --clients 10 --state ready`` serves the page on it, to look at.
"""

import argparse
import math
import os
import socket
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np
import uvicorn

from app.server import create_app
from vision_core.clock import Instant, MonotonicClock, after
from vision_core.field_model import field_segments
from vision_core.geometry import Bytes, Floats
from vision_core.rtdb import records
from vision_core.rtdb.records import (
    ClientInfo,
    Processes,
    ProcessInfo,
    ServiceInfo,
    Serving,
    SourceInfo,
    TaskInfo,
)
from vision_core.rtdb.store import Store, create_block
from vision_core.settings import Settings
from vision_core.settings_files import load_settings
from vision_core.settings_models import camera_model_from, mirror_from
from vision_core.tasks.table import record_specs, task_table
from vision_core.types.field import EdgeKind
from vision_core.types.objects import BallSighting, RobotSighting, Sightings, Team
from vision_core.types.tracks import BallTrack, RobotTrack, World
from vision_core.types.views import Views, ViewSnapshot

CAMERA = "main"
TASKS = task_table(CAMERA)
COLORS = {Team.BLUE: (220, 90, 30), Team.YELLOW: (40, 200, 240)}


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
    reasons: tuple[str, ...] = ()
    repeats: bool = False


class FakeService:
    """The database of a service, and what its tasks would write."""

    def __init__(self, scene: Scene | None = None, settings: Settings | None = None) -> None:
        self.scene = scene or Scene()
        self.settings = settings or load_settings()
        self.clock = MonotonicClock()
        self.specs = record_specs(self.settings, TASKS)
        self.block = create_block(self.specs)
        self.store = Store(self.specs, self.block)
        self.boot = self.clock.now()
        self._writers = {spec.name: self.store.writer(spec.name) for spec in self.specs}
        self._camera = camera_model_from(self.settings)
        self._carpet = self._drawn_carpet()
        self._stop = threading.Event()
        self._thread: threading.Thread | None = None
        self._frames = 0
        self.put(
            records.SERVICE,
            ServiceInfo("0.1.0", self.boot, "http://127.0.0.1:8000", "127.0.0.1:6000, sessions 6001", self.settings),
        )

    def put(self, item: records.Item[records.T], value: records.T, measured: Instant | None = None) -> None:
        """Write a record."""
        now = self.clock.now()
        self._writers[item.spec.name].write(item.encode(value), now if measured is None else measured, now)

    def write_processes(self) -> None:
        """What the supervisor writes."""
        infos = []
        for index, name in enumerate(task.name for task in TASKS):
            state, detail = self.scene.states.get(name, ("done" if name == "compile" else "running", ""))
            infos.append(ProcessInfo(name, 4000 + index if state == "running" else None, state, 0, detail))
        self.put(records.PROCESSES, Processes(tuple(infos)))
        for name in ("capture", "perceive", "serve"):
            if name not in self.scene.states:
                self.put(records.task(name), TaskInfo(os.getpid(), self._frames, 2, 30.0, 4.1, 7.9, ""))

    def write_frame(self) -> None:
        """What the tasks write for one image."""
        grabbed = self.clock.now()
        t = (grabbed - self.boot) / 1e9
        self._frames += 1
        poses = self._poses(t) if self.scene.robots else []
        ball = (0.9 * math.sin(0.5 * t), 0.7 * math.cos(0.37 * t))
        pixels = self._drawn(poses, ball)
        self._writers[f"frames/{CAMERA}"].write(pixels.tobytes(), grabbed, self.clock.now())
        source = SourceInfo("synthetic", "simulated ceiling camera", self.scene.repeats, 30.0)
        self.put(records.source(CAMERA), source)
        self.put(records.sightings(CAMERA), self._sightings(poses, ball, grabbed), grabbed)
        self.put(records.WORLD, self._world(poses, ball, grabbed), grabbed)
        views = tuple(self._view(index, poses, ball) for index in range(int(self.scene.unread), len(poses)))
        self.put(records.VIEWS, Views(self._frames, grabbed, views), grabbed)
        self.put(records.SERVING, self._serving())

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

    def _run(self) -> None:
        while not self._stop.wait(1.0 / 30.0):
            self.write_processes()
            if self.scene.image:
                self.write_frame()

    def _poses(self, t: float) -> list[tuple[Team, int, float, float, float]]:
        poses = []
        for index in range(2 * self.settings.match.numbers - self.scene.missing):
            team = Team.BLUE if index < self.settings.match.numbers else Team.YELLOW
            number = index % self.settings.match.numbers + 1
            phase = 0.4 * t + index * math.tau * 0.3
            side = -0.55 if team is Team.BLUE else 0.55
            x = side + (0.25 + 0.08 * number) * math.cos(phase)
            y = (number - 3) * 0.38 + 0.12 * math.sin(1.3 * phase)
            poses.append((team, number, x, y, phase + 1.2))
        return poses

    def _drawn_carpet(self) -> Bytes:
        camera = self.settings.camera
        carpet = np.full((camera.height_px, camera.width_px, 3), (45, 90, 50), dtype=np.uint8)
        noise = np.random.default_rng(1).integers(0, 12, carpet.shape, dtype=np.uint8)
        return carpet + noise

    def _drawn(self, poses: list[tuple[Team, int, float, float, float]], ball: tuple[float, float]) -> Bytes:
        image = self._carpet.copy()
        height = self.settings.robots.height_m
        for team, _number, x, y, _heading in poses:
            self._disc(image, (x, y), height, 18.0, (30, 30, 30))
            self._disc(image, (x, y), height, 5.0, COLORS[team])
        self._disc(image, ball, 0.0, 4.0, (20, 120, 240))
        return image

    def _disc(
        self, image: Bytes, at: tuple[float, float], height: float, radius: float, color: tuple[int, int, int]
    ) -> None:
        x, y = self._camera.pixel_from_field(np.array([at]), height)[0]
        reach = int(radius) + 1
        x0, y0 = max(int(x) - reach, 0), max(int(y) - reach, 0)
        patch = image[y0 : int(y) + reach + 1, x0 : int(x) + reach + 1]
        rows, columns = np.indices(patch.shape[:2])
        patch[(columns + x0 - x) ** 2 + (rows + y0 - y) ** 2 <= radius**2] = color

    def _sightings(
        self, poses: list[tuple[Team, int, float, float, float]], ball: tuple[float, float], grabbed: Instant
    ) -> Sightings:
        robots = []
        for team, number, x, y, heading in poses:
            px, py = self._camera.pixel_from_field(np.array([[x, y]]), self.settings.robots.height_m)[0]
            robots.append(RobotSighting(team, number, float(px), float(py), x, y, heading, 0.93, 0.001, 0.01))
        if self.scene.unread:
            robots[0] = replace(robots[0], id=None, heading_rad=None)
        px, py = self._camera.pixel_from_field(np.array([ball]))[0]
        balls = (BallSighting(float(px), float(py), *ball, 0.88, 0.001),)
        return Sightings(CAMERA, self._frames, grabbed, after(grabbed, 0.006), tuple(robots), balls, self.scene.reasons)

    def _world(
        self, poses: list[tuple[Team, int, float, float, float]], ball: tuple[float, float], grabbed: Instant
    ) -> World:
        robots = tuple(
            RobotTrack(team, number, x, y, heading, 0.1, 0.2, 0.4, 0.001, 0.01, 0.93, grabbed)
            for team, number, x, y, heading in poses
        )
        if self.scene.unread:
            robots = (replace(robots[0], id=None, heading_rad=0.0, heading_sd_rad=1.8), *robots[1:])
        return World(self._frames, grabbed, robots, BallTrack(*ball, 0.4, -0.2, 0.002, False, grabbed), ())

    def _view(
        self, own: int, poses: list[tuple[Team, int, float, float, float]], ball: tuple[float, float]
    ) -> ViewSnapshot:
        team, number, x, y, heading = poses[own]
        angles = heading + np.radians(np.arange(360.0))
        reach, kinds = self._nearest(own, poses, np.array([x, y]), np.column_stack([np.cos(angles), np.sin(angles)]))
        mirror = mirror_from(self.settings)
        px = np.where(kinds == EdgeKind.NOTHING, 255.0, mirror.px_from_mm(np.minimum(reach, 20.0) * 1000.0))
        dx, dy = ball[0] - x, ball[1] - y
        away = math.hypot(dx, dy)
        direction = round(math.degrees(math.atan2(dy, dx) - heading)) % 360
        hidden = away > reach[direction]
        return ViewSnapshot(
            team=team,
            number=number,
            px=px.astype(np.uint8).tobytes(),
            kinds=kinds.astype(np.uint8).tobytes(),
            ball_px=-1 if hidden else int(mirror.px_from_mm(away * 1000.0)),
            ball_direction_deg=0 if hidden else direction,
            ball_size_deg=0 if hidden else max(1, round(math.degrees(2 * 0.02135 / away))),
            partial=False,
            overlap=False,
        )

    def _nearest(
        self, own: int, poses: list[tuple[Team, int, float, float, float]], origin: Floats, rays: Floats
    ) -> tuple[Floats, Floats]:
        reach = np.full(len(rays), np.inf)
        kinds = np.zeros(len(rays))
        for piece in field_segments(self.settings.field, "left"):
            start = np.array([piece.x1_m, piece.y1_m]) - origin
            along = np.array([piece.x2_m - piece.x1_m, piece.y2_m - piece.y1_m])
            with np.errstate(divide="ignore", invalid="ignore"):
                cross = rays[:, 0] * along[1] - rays[:, 1] * along[0]
                t = (start[0] * along[1] - start[1] * along[0]) / cross
                u = (start[0] * rays[:, 1] - start[1] * rays[:, 0]) / cross
            hit = (t > 0) & (u >= 0) & (u <= 1) & (t < reach)
            reach[hit], kinds[hit] = t[hit], piece.kind
        for index, (team, number, x, y, _heading) in enumerate(poses):
            if index == own:
                continue
            middle = rays @ (np.array([x, y]) - origin)
            root = self.settings.robots.radius_m**2 - (np.sum((np.array([x, y]) - origin) ** 2) - middle**2)
            t = middle - np.sqrt(np.maximum(root, 0.0))
            hit = (root > 0) & (t > 0) & (t < reach)
            base = EdgeKind.ROBOT_BLUE if team is Team.BLUE else EdgeKind.ROBOT_YELLOW
            reach[hit], kinds[hit] = t[hit], base + number
        return reach, kinds

    def _serving(self) -> Serving:
        per_team = self.settings.match.numbers
        clients = tuple(
            ClientInfo(
                team=Team.BLUE if index < per_team else Team.YELLOW,
                number=index % per_team + 1,
                address="127.0.0.1",
                port=50000 + index,
                since=self.boot,
                sent=self._frames,
                dropped=3 if index == 2 else 0,
                rate_hz=30.0,
                mean_rank=0.48 + 0.004 * index,
            )
            for index in range(self.scene.clients)
        )
        return Serving(clients, 12.4, 19.8, ())


class PageServer:
    """The application on a fake service, on a real socket of this process."""

    def __init__(self, service: FakeService, port: int = 0) -> None:
        self._listener = socket.create_server(("127.0.0.1", port))
        self.address = f"127.0.0.1:{self._listener.getsockname()[1]}"
        config = uvicorn.Config(
            create_app(service.store), log_level="warning", access_log=False, lifespan="on", timeout_graceful_shutdown=1
        )
        self._server = uvicorn.Server(config)
        self._thread = threading.Thread(target=self._server.run, args=([self._listener],), daemon=True)

    def start(self) -> None:
        """Serve; returns when it does."""
        self._thread.start()
        wait_for(lambda: self._server.started)

    def stop(self) -> None:
        """Stop serving; open pages are closed."""
        self._server.should_exit = True
        self._thread.join()


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
            "perceive": ("waiting", ""),
            "serve": ("waiting", ""),
        },
    ),
    "blind": Scene(image=False),
    "crashing": Scene(states={"perceive": ("disabled", "5 ends within a minute, the last with signal SIGSEGV")}),
    "unread": Scene(unread=True, missing=1),
    "empty": Scene(robots=False, reasons=("no blob is large enough to be a dot of a marker",), repeats=True),
}


def main() -> None:
    """Serve the page on a fake service until interrupted."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--port", type=int, default=8100)
    parser.add_argument("--clients", type=int, default=10)
    parser.add_argument("--state", choices=sorted(STATES), default="ready")
    parser.add_argument("--preset", default="ssl-2002")
    chosen = parser.parse_args()
    scene = replace(STATES[chosen.state], clients=chosen.clients)
    service = FakeService(scene, load_settings(options={"field_preset": chosen.preset}))
    service.start()
    PageServer(service, chosen.port).start()
    threading.Event().wait()


if __name__ == "__main__":
    main()
