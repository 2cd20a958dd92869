"""CAMBADA's detectors find their objects in rendered frames, and find nothing where these are missing."""

import math
import os
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import pytest

from bench.cambada.activation_log import BEGAN, IMAGE, ActivationLog, read_log
from bench.cambada.detectors import DETECTORS, Detector, Positions, detector_of
from bench.cambada.image_sequence import labeled_frames
from bench.cambada.monolith import BALL, LOOP, run
from bench.cambada.paper import TASKS
from bench.cambada.profiles import Strip, normals
from bench.cambada.tasks import Detection, start
from bench.cambada.venue import IMAGES, LOGS, log_folder_of, write_venue
from vision_core.capture.synthetic.render import Renderer
from vision_core.capture.synthetic.world import Snapshot, World
from vision_core.clock import NS_PER_S, Instant, MonotonicClock
from vision_core.geometry import Bytes, Floats
from vision_core.models.camera_setup import CameraSetup
from vision_core.rtdb.store import create_block
from vision_core.scheduling.attachment import Attachment, ChildResources
from vision_core.scheduling.handle import Handle
from vision_core.scheduling.releases import IDLE, RAN, Release
from vision_core.tasks.table import check_table, record_specs, task_table
from vision_core.venues.loader import layers_of, load_settings, place_of, settings_from_layers

SETTINGS = load_settings(options={"camera.rate_hz": 20.0})
CAMERA = CameraSetup.from_settings(SETTINGS).model
SIZE = CameraSetup.from_settings(SETTINGS).size_px
NEAR_PX = SETTINGS.robots.radius_m * CAMERA.pixels_per_metre((0.0, 0.0))
"""A robot's radius in the middle of the picture."""
APART_PX = 60.0
"""Robots whose centers are nearer may be detected as one obstacle."""
FRAMES = 126
"""The ball is missing for some of them, then the goals."""
EMPTY: dict[str, Any] = {"synthetic.robots_per_team": 0, "synthetic.walking_people": 0}
PLAIN: dict[str, Any] = {"field.walls": False, "field.line_width_m": 0.0, "field.goal.depth_m": 0.0}


@dataclass(frozen=True)
class Observation:
    """What the detectors found in one frame, and the truth."""

    scene: Snapshot
    ball: bool
    goals: bool
    found: dict[str, Positions | None]


@cache
def observations() -> tuple[Observation, ...]:
    """Run every detector on the sequence once."""
    detectors = {name: detector_of(name, SETTINGS) for name in DETECTORS}
    all_observations = []
    for number, frame in enumerate(labeled_frames(SETTINGS, FRAMES)):
        at = Instant(number * NS_PER_S // 20)
        found = {name: detector.detect(frame.pixels, at) for name, detector in detectors.items()}
        all_observations.append(Observation(frame.scene, frame.ball, frame.goals, found))
    return tuple(all_observations)


def recall(name: str, *, among: list[Observation]) -> float:
    return sum(observation.found[name] is not None for observation in among) / len(among)


def image_of(options: dict[str, Any], *, ball: bool = True) -> Bytes:
    """A frame of another venue, through the same camera."""
    settings = load_settings(options=options)
    camera, world = CameraSetup.from_settings(settings), World(settings)
    scene = world.snapshot()
    scene.ball[:2] = (0.3, 0.2) if ball else (3.0, 3.0)
    pixels = camera.black_image()
    Renderer(settings, camera, world.robots_worn).draw(pixels, scene)
    return pixels


def px(points_m: list[tuple[float, float]], height_m: float = 0.0) -> Floats:
    return CAMERA.pixel_from_field(np.array(points_m), height_m)


def farthest(found: Positions, places: Floats) -> float:
    """The largest distance of a true place from the nearest position found [px]."""
    return max(min(math.dist(place, other) for other in found) for place in places.tolist())


def test_every_task_of_the_paper_has_a_detector() -> None:
    assert list(DETECTORS) == list(TASKS)


@pytest.mark.slow
@pytest.mark.parametrize("name", sorted(set(DETECTORS) - {"ball_om", "kgoal", "bgoal", "ygoal"}))
def test_objects_that_are_always_present_are_found(name: str) -> None:
    assert recall(name, among=list(observations())) >= 0.98


@pytest.mark.slow
def test_the_ball_is_found_where_it_is_present() -> None:
    assert recall("ball_om", among=[observation for observation in observations() if observation.ball]) >= 0.95
    assert recall("ball_om", among=[observation for observation in observations() if not observation.ball]) == 0.0
    places = [
        (observation.found["ball_om"], observation.scene.ball) for observation in observations() if observation.ball
    ]
    errors = [farthest(found, px([(ball[0], ball[1])], SETTINGS.ball.radius_m)) for found, ball in places if found]
    assert np.median(errors) < 0.5


@pytest.mark.slow
@pytest.mark.parametrize("name", ["bgoal", "ygoal", "kgoal"])
def test_goals_and_the_keepers_line_are_found_where_they_are_present(name: str) -> None:
    assert recall(name, among=[observation for observation in observations() if observation.goals]) >= 0.9
    assert recall(name, among=[observation for observation in observations() if not observation.goals]) == 0.0


@pytest.mark.slow
def test_positions_agree_with_the_truth() -> None:
    last, field = observations()[99], SETTINGS.field
    robots = px([(x, y) for x, y in last.scene.robots[:, :2].tolist()], SETTINGS.robots.height_m / 2.0)
    goals = px([(-1.58, 0.0), (1.58, 0.0)], field.wall_height_m / 2.0)
    corners = px([(x, y) for x in (-1.39, 1.39) for y in (-1.14, 1.14)])
    everything = {name: found or () for name, found in last.found.items()}
    assert farthest(everything["ball_fr"], robots) < NEAR_PX
    assert farthest((*everything["bgoal"], *everything["ygoal"]), goals) < 4.0
    assert farthest((*everything["bpost"], *everything["ypost"]), corners) < 0.5
    assert farthest(everything["kgoal"], px([(-1.395, 0.0)])) < 2.0
    assert farthest(everything["line"], px([(0.0, 0.0), (-1.17, 0.0), (1.17, 0.0)])) < 2.0


@pytest.mark.slow
def test_a_robot_that_stands_alone_is_an_obstacle() -> None:
    alone, found = 0, 0
    for observation in observations():
        robots = px(
            [(x, y) for x, y in observation.scene.robots[:, :2].tolist()], SETTINGS.robots.height_m / 2.0
        ).tolist()
        for robot in robots:
            if min(math.dist(robot, other) for other in robots if other is not robot) > APART_PX:
                alone += 1
                found += farthest(observation.found["avoid_om"] or (), np.array([robot])) < NEAR_PX
    assert alone > FRAMES
    assert found >= 0.95 * alone


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "venue"),
    [("avoid_om", EMPTY), ("ball_om", EMPTY), ("ball_fr", EMPTY)]
    + [(name, PLAIN) for name in ("kgoal", "bgoal", "ygoal", "line", "bpost", "ypost")],
)
def test_an_object_that_is_missing_is_not_found(name: str, venue: dict[str, Any]) -> None:
    assert detector_of(name, SETTINGS).detect(image_of(venue, ball=False), Instant(1)) is None


@pytest.mark.slow
def test_an_empty_floor_has_no_boundary() -> None:
    floor = np.full((SIZE[1], SIZE[0], 3), (110, 148, 178), dtype=np.uint8)
    assert detector_of("avoid_fr", SETTINGS).detect(floor, Instant(1)) is None


@pytest.mark.parametrize("offset", [-3.0, 0.0, 2.0])
def test_a_strip_measures_the_offset_of_a_line_and_of_an_edge(offset: float) -> None:
    path_px = np.column_stack([np.full(30, 300.0), np.linspace(100.0, 300.0, 30)])
    path_m = CAMERA.field_from_pixel(path_px)
    across = normals(path_m)
    strip = Strip(CAMERA, path_m, across, SIZE)
    direction = round(float(np.sign(strip.normal[0])))
    column = round(300.0 + direction * offset)
    pixels = np.full((SIZE[1], SIZE[0], 3), 60, dtype=np.uint8)
    assert strip.line_px(pixels) is None
    assert strip.edge_px(pixels) is None
    pixels[:, column] = 200
    assert strip.line_px(pixels) == pytest.approx(offset, abs=0.6)
    beyond = np.s_[:, column:] if direction > 0 else np.s_[:, : column + 1]
    pixels[beyond] = 200
    assert strip.edge_px(pixels) == pytest.approx(offset, abs=1.1)


def test_a_strip_outside_the_picture_finds_nothing() -> None:
    path_m = np.column_stack([np.full(30, 4.0), np.linspace(-1.0, 1.0, 30)])
    strip = Strip(CAMERA, path_m, normals(path_m), SIZE)
    assert strip.line_px(np.full((SIZE[1], SIZE[0], 3), 60, dtype=np.uint8)) is None


def test_a_log_has_the_runs_of_all_processes_in_order(tmp_path: Path) -> None:
    later, earlier = ActivationLog(), ActivationLog()
    later.add(30, 31, 32, 3, found=False)
    for number in (1, 2):
        earlier.add(number * 10, number * 10 + 1, number * 10 + 2, number, found=True)
    later.save(tmp_path, "task")
    earlier.save(tmp_path, "task.0")
    (tmp_path / f"task.0.{os.getpid()}.npy").rename(tmp_path / "task.1.npy")
    assert read_log(tmp_path, "task").tolist() == [[10, 11, 12, 1, 1], [20, 21, 22, 2, 1], [30, 31, 32, 3, 0]]
    assert read_log(tmp_path, "nothing").shape == (0, 5)
    later.save(tmp_path / "nowhere", "task")


def test_the_venue_has_the_papers_table(tmp_path: Path) -> None:
    layers = layers_of(str(write_venue(tmp_path)))
    settings = settings_from_layers(layers)
    check_table(settings, lambda key: place_of(key, layers))
    table = {task.name: task for task in task_table(settings)}
    for name, timing in TASKS.items():
        task = table[name]
        every_frame = timing.period_ms * settings.camera.rate_hz == 1000.0
        released = ("frames/main", 0.0) if every_frame else ("period", timing.period_ms)
        assert (task.trigger, task.times.period_ms) == released
        assert task.rate_hz(settings.camera.rate_hz) == pytest.approx(1000.0 / timing.period_ms)
        assert (task.times.priority, task.times.offset_ms) == (timing.priority, timing.offset_ms)
        assert (task.process, task.times.enabled) == (name, True)
    assert {task.process for task in table.values() if task.name in TASKS} == set(TASKS)
    others = [task for task in table.values() if task.name not in {*TASKS, "capture"} and task.times.enabled]
    assert max(task.times.priority for task in others) < min(timing.priority for timing in TASKS.values())
    assert log_folder_of(settings.source.uri) == tmp_path / LOGS
    assert settings.source.uri == f"file:{tmp_path / IMAGES}"


class RecordingDetector:
    """A detector that records which images it was given, and when they were due."""

    def __init__(self, pause_s: float = 0.0) -> None:
        self.images: list[tuple[int, int]] = []
        self._now = MonotonicClock().now
        self._pause_ns = round(pause_s * NS_PER_S)

    def detect(self, pixels: Bytes, at: Instant) -> Positions | None:
        self.images.append((int(pixels[0, 0, 0]), int(at)))
        begin = self._now()
        while self._now() - begin < self._pause_ns:
            pass
        return None


def test_the_loop_gives_every_detector_the_newest_frame_and_skips_frames_when_it_is_too_slow() -> None:
    images = [np.full((2, 2, 3), number, dtype=np.uint8) for number in range(3)]
    first, second = RecordingDetector(), RecordingDetector(pause_s=0.08)
    detectors: dict[str, Detector] = {"ball_om": first, "other": second}
    logs = run(images, detectors, 0.4)
    assert first.images == second.images
    rows, ball = logs[LOOP].rows, logs[BALL].rows
    assert [number % 3 for number in rows[:, IMAGE]] == [frame for frame, _ in first.images]
    assert (np.diff(rows[:, IMAGE]) >= 1).all()
    assert rows[-1, IMAGE] > len(rows) - 1
    assert (rows[:, BEGAN] <= ball[:, BEGAN]).all()


@pytest.mark.slow
def test_a_task_writes_what_it_detects_in_the_newest_image(tmp_path: Path) -> None:
    settings = load_settings(venue=str(write_venue(tmp_path)))
    task = next(task for task in task_table(settings) if task.name == "bgoal")
    specs = record_specs(settings, [task], ["bgoal"])
    block = create_block(specs)
    attachment = Attachment(ChildResources("bgoal", os.getpid(), 0, block, specs, None, {}, {}))
    handle, clock = Handle(task, attachment, settings, CameraSetup.from_settings(settings)), MonotonicClock()
    step = start(handle)
    release = Release(clock.now(), clock.now())
    assert step(release) == IDLE, "there is no image yet"
    frames = attachment.store.writer("frames/main")
    frames.write(image_of({}).tobytes(), clock.now(), clock.now())
    assert step(release) == RAN
    reading = attachment.store.reader("cambada/bgoal").read(clock.now())
    assert reading is not None
    detection = msgspec.msgpack.decode(bytes(reading.value), type=Detection)
    assert detection.image == 1
    assert detection.positions is not None
    assert farthest(detection.positions, px([(-1.58, 0.0)], 0.05)) < 4.0
    os.close(block)
