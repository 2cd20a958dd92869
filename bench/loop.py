"""Duration of the whole pipeline for one frame, from pixels to sent datagrams.

Distinct frames of a simulated match, rendered beforehand and looped; the table says how many. In one process and thread
each frame is perceived (windows around known objects, scan band, the whole picture when something is missing), tracked,
rendered as every robot's view, encoded for every client and sent over loopback through one socket per client. The
service does the same in two processes, one after the other.

Measured [us]: median duration of a frame, and of each stage. Baseline: the reference segmentation of the same frames
alone, in Python and in C; a ratio below 1 means that the whole pipeline takes less time than that one stage of a
classical system. Pipeline and baselines take turns in blocks of frames. At 1280x1024 with 22 robots the sustained rate
is given too [frames per second], the clients' receiving included.
"""

import contextlib
import socket
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from bench.accuracy import TEAMS, settings_of
from bench.runner import Row
from bench.segmentation import c_reference_of
from bench.segmenters import ReferenceSegmenter
from vision_core.capture.source import open_source
from vision_core.clock import NS_PER_S, US_PER_S, Instant, ManualClock, MonotonicClock
from vision_core.geometry import Bytes
from vision_core.models.camera_setup import CameraSetup
from vision_core.net.delivery import DeliveryTable
from vision_core.net.delivery_rows import new_rows
from vision_core.net.udp import SharedSocket
from vision_core.pipeline.perception import Perception
from vision_core.pipeline.view_encoder import ViewEncoder
from vision_core.protocol.options import PAPER_OPTIONS, Options
from vision_core.settings.schema import Settings
from vision_core.tracks.tracker import Tracker
from vision_core.types.fairness import robot_index
from vision_core.types.image import ImageFrame
from vision_core.types.objects import Team

CASES = {("640x480", 10): 0.5, ("1280x1024", 10): 0.2, ("2048x1536", 22): None, ("1280x1024", 22): None}
"""Size and robots of each case, and its goal: the largest ratio to the reference segmentation alone."""
FRAMES = {"640x480": 400, "1280x1024": 200, "2048x1536": 80}
ROUNDS, BLOCK, UNMEASURED = 4, 40, 5
"""Times that all frames are looped; frames in a block; frames at the start of a block that are not measured."""
SUSTAINED = ("1280x1024", 22)
SUSTAINED_HZ = 500.0
PERIOD_NS = NS_PER_S // 30
STAGES = ("perceive", "track", "write", "send")


@dataclass(frozen=True)
class Client:
    """What a session asks for."""

    team: Team
    number: int
    options: Options = PAPER_OPTIONS
    nul: bool = False


def run() -> list[Row]:
    """Rows for every case."""
    rows = []
    for (size, robots), goal in CASES.items():
        with _loop(size, robots) as loop:
            rows += _measure(loop, f"{size}, {robots} robots, {len(loop.frames)} frames", goal)
            if (size, robots) == SUSTAINED:
                rows.append(_sustained(loop))
    return rows


class Loop:
    """The pipeline in one process: from a frame to the datagrams of all clients."""

    def __init__(self, settings: Settings, frames: list[Bytes], stack: contextlib.ExitStack) -> None:
        self.settings, self.frames = settings, frames
        self._clock = MonotonicClock()
        self.perception = Perception(settings, CameraSetup.from_settings(settings))
        self._tracker = Tracker(settings.tracks, settings.robots)
        self._encoder = ViewEncoder(settings, Instant(0))
        numbers = range(1, settings.match.numbers + 1)
        self._clients = tuple(Client(team, number) for team in Team for number in numbers)
        self._sockets = [_client(stack) for _ in self._clients]
        server = stack.enter_context(socket.socket(socket.AF_INET, socket.SOCK_DGRAM))
        server.bind(("127.0.0.1", 0))
        shared = SharedSocket(server)
        sessions = [shared.open_session("127.0.0.1", (*one.getsockname(), 0)) for one in self._sockets]
        for session in sessions:
            stack.callback(session.close)
        self._deliveries = DeliveryTable(Instant(0), seed=1)
        self._deliveries.replace(new_rows(len(sessions)))
        for row, (client, session) in enumerate(zip(self._clients, sessions, strict=True)):
            self._deliveries.address(row, robot_index(client.team, client.number), session.fileno(), PAPER_OPTIONS)
        self._number = 0

    def turn(self, frame: int) -> tuple[float, ...]:
        """Process one frame. Returns when it began and when each stage was done [s of time.perf_counter]."""
        self._number += 1
        at = Instant(self._number * PERIOD_NS)
        began = time.perf_counter()
        seen = self.perception.perceive(ImageFrame("main", self._number, at, self.frames[frame]), self._clock)
        perceived = time.perf_counter()
        world = self._tracker.update(seen)
        tracked = time.perf_counter()
        batch = self._encoder.write(world, self._clients, self._deliveries.due(at))
        written = time.perf_counter()
        self._deliveries.send(at, batch)
        return began, perceived, tracked, written, time.perf_counter()

    def drain(self) -> int:
        """Receive all datagrams that wait in the clients' sockets. Returns their number."""
        taken = 0
        for client in self._sockets:
            with contextlib.suppress(BlockingIOError):
                while client.recv(4096):
                    taken += 1
        return taken


@contextlib.contextmanager
def _loop(size: str, robots: int) -> Iterator[Loop]:
    per_team = TEAMS[robots]
    settings = settings_of(size, {"synthetic.robots_per_team": per_team, "match.numbers": per_team})
    source = open_source(settings, CameraSetup.from_settings(settings), ManualClock(), paced=False)
    frames = []
    for _ in range(FRAMES[size]):
        pixels = CameraSetup.from_settings(settings).black_image()
        source.grab(pixels)
        frames.append(pixels)
    source.close()
    with contextlib.ExitStack() as stack:
        yield Loop(settings, frames, stack)


def _client(stack: contextlib.ExitStack) -> socket.socket:
    client = stack.enter_context(socket.socket(socket.AF_INET, socket.SOCK_DGRAM))
    client.bind(("127.0.0.1", 0))
    client.setblocking(False)
    return client


def _measure(loop: Loop, name: str, goal: float | None) -> list[Row]:
    table = loop.perception.table
    reference = ReferenceSegmenter(*loop.perception.camera.size_px, loop.settings.blobs)
    c_reference, _ = c_reference_of(loop.settings, table, loop.frames)
    references: dict[str, Callable[[int], object]] = {
        "reference": lambda frame: reference.segment(loop.frames[frame], table)
    }
    if c_reference is not None:
        references["C"] = c_reference[0]
    timestamps: list[tuple[float, ...]] = []
    reference_times: dict[str, list[float]] = {key: [] for key in references}
    count, sent = len(loop.frames), 0
    # pipeline and baselines take turns, a block of frames each
    for block in range(0, ROUNDS * count, BLOCK):
        frames = [number % count for number in range(block, block + BLOCK)]
        for place, frame in enumerate(frames):
            times = loop.turn(frame)
            sent += loop.drain()
            if place >= UNMEASURED:
                timestamps.append(times)
        for key, call in references.items():
            reference_times[key] += [_seconds(call, frame) for frame in frames][UNMEASURED:]
    durations = np.diff(np.array(timestamps), axis=1)
    whole_s = float(np.median(durations.sum(axis=1)))
    reference_s = float(np.median(reference_times["reference"]))
    rows: list[Row] = [_row(f"{name}: pixels to sent, reference segmentation alone", whole_s, reference_s, goal)]
    if "C" in reference_times:
        c_s = float(np.median(reference_times["C"]))
        rows.append(_row(f"{name}: pixels to sent, reference segmentation in C alone", whole_s, c_s, None))
    for stage, seconds in zip(STAGES, np.median(durations, axis=0).tolist(), strict=True):
        rows.append({"name": f"{name}: {stage}", "value": seconds * US_PER_S, "unit": "us"})
    rows.append({"name": f"{name}: datagrams per frame", "value": round(sent / (ROUNDS * count), 2), "unit": ""})
    return rows


def _seconds(call: Callable[[int], object], frame: int) -> float:
    began = time.perf_counter()
    call(frame)
    return time.perf_counter() - began


def _sustained(loop: Loop) -> Row:
    """The sustained rate [frames per second]: the clients' receiving is the only other work, and counts."""
    count = len(loop.frames)
    began = time.perf_counter()
    for turn in range(ROUNDS * count):
        loop.turn(turn % count)
        loop.drain()
    rate = ROUNDS * count / (time.perf_counter() - began)
    size, robots = SUSTAINED
    name = f"{size}, {robots} robots, {count} frames: sustained, clients' receiving included"
    return {
        "name": name,
        "value": round(rate, 1),
        "unit": "1/s",
        "goal": f">= {SUSTAINED_HZ:g} 1/s",
        "met": rate >= SUSTAINED_HZ,
    }


def _row(name: str, seconds: float, baseline_s: float, goal: float | None) -> Row:
    judged: Row = {} if goal is None else {"goal": f"<= {goal:g}x", "met": seconds <= goal * baseline_s}
    return {
        "name": name,
        "value": seconds * US_PER_S,
        "unit": "us",
        "baseline": baseline_s * US_PER_S,
        "ratio": seconds / baseline_s,
    } | judged
