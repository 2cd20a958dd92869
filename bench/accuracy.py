"""The whole way from pixels to sightings against the truth of the synthetic camera.

The world is rendered to pixels and detected from pixels; the truth is used only to score. A robot counts
as found when a sighting lies within 5 cm of it; its id is right when team and id agree. Errors are those of single
sightings, without the tracker's smoothing; the ball counts where at least half of it can be seen.

At rest (``speed 0``) *noise* is the scatter of the sightings of one thing about their own mean, over several places;
NEES is the mean squared error over the variance that the sighting claims, per degree of freedom: 1 is honest.
"""

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from bench.runner import Row
from vision_core.capture.source import open_source
from vision_core.capture.synthetic.camera import SyntheticCamera
from vision_core.capture.synthetic.truth import Truth
from vision_core.clock import MonotonicClock
from vision_core.geometry import wrap_angle
from vision_core.models.camera_setup import CameraSetup
from vision_core.pipeline.perception import Perception
from vision_core.settings.schema import Settings
from vision_core.types.image import ImageFrame
from vision_core.types.objects import RobotSighting, Sightings, Team
from vision_core.venues.loader import load_settings

MATCH_M = 0.05
WHOLE = 0.99
HALF = 0.5
SIZES = {"640x480": (640, 480, 700.0), "1280x1024": (1280, 1024, 1420.0), "2048x1536": (2048, 1536, 2200.0)}
"""Width, height and focal length [px]."""
LOOKS: dict[str, dict[str, Any]] = {
    "default": {},
    "doubled noise": {"synthetic.read_noise": 3.0, "synthetic.shot_noise": 0.32},
    "40 % light, colors.light.adapt": {"synthetic.brightness": 0.4, "colors.light.adapt": True},
    "40 % light": {"synthetic.brightness": 0.4},
    "3 m/s, 10 ms exposure": {"synthetic.speed_m_s": 3.0, "synthetic.exposure_ms": 10.0},
}
TEAMS = {10: 5, 22: 11}
FRAMES = {"640x480": 600, "1280x1024": 300, "2048x1536": 150}
REST_SEEDS, REST_FRAMES = 6, 25
ROBOT_NOISE_MM, HEADING_NOISE_DEG, BALL_NOISE_MM = 0.08, 0.07, 0.10
"""Goals at 1280x1024."""

Key = tuple[Team, int | None]


@dataclass
class Score:
    """What was counted over all frames."""

    robots: int = 0
    found: int = 0
    right_id: int = 0
    wrong_id: int = 0
    false: int = 0
    balls: int = 0
    balls_found: int = 0
    balls_false: int = 0
    position_m: list[float] = field(default_factory=list)
    heading_rad: list[float] = field(default_factory=list)
    ball_m: list[float] = field(default_factory=list)
    """Errors of a ball that is wholly visible."""
    position_ratio: list[float] = field(default_factory=list)
    """Errors over the deviations that the sightings claim."""
    heading_ratio: list[float] = field(default_factory=list)
    ball_ratio: list[float] = field(default_factory=list)


def run() -> list[Row]:
    """Score every size, number of robots and look."""
    rows: list[Row] = []
    for size, frames in FRAMES.items():
        for robots, per_team in TEAMS.items():
            for look, options in LOOKS.items():
                settings = settings_of(size, {"synthetic.robots_per_team": per_team} | options)
                score = score_settings(settings, frames)
                rows += [{"name": f"{size}, {robots} robots, {look}: {key}"} | row for key, row in _summary(score)]
    for size in SIZES:
        rows += [{"name": f"{size}, at rest: {key}"} | row for key, row in _at_rest(size)]
    return rows


def settings_of(size: str, options: dict[str, Any]) -> Settings:
    """The demo's settings at another size and look."""
    width, height, focal = SIZES[size]
    center = [width / 2.0 - 2.9, height / 2.0 + 2.6]
    camera = {"width_px": width, "height_px": height, "pinhole.focal_px": focal, "pinhole.center_px": center}
    # 22 robots: the second team's numbers reach beyond the default match
    return load_settings(options={f"camera.{key}": value for key, value in camera.items()} | options)


def score_settings(settings: Settings, frames: int) -> Score:
    """Render and perceive a number of frames."""
    score = Score()
    for truth, seen in perceived(settings, frames):
        _count_robots(score, truth, seen)
        _count_ball(score, truth, seen)
    return score


def perceived(settings: Settings, frames: int) -> list[tuple[Truth, Sightings]]:
    """Truth and sightings of a number of frames."""
    clock = MonotonicClock()
    source = open_source(settings, CameraSetup.from_settings(settings), clock, paced=False)
    assert isinstance(source, SyntheticCamera)
    perception = Perception(settings, CameraSetup.from_settings(settings))
    perception.warm_up()
    pixels = CameraSetup.from_settings(settings).black_image()
    pairs = []
    for number in range(1, frames + 1):
        grabbed = source.grab(pixels)
        seen = perception.perceive(ImageFrame(settings.camera.name, number, grabbed, pixels), clock)
        pairs.append((source.truth, seen.record()))
    source.close()
    return pairs


def _count_robots(score: Score, truth: Truth, seen: Sightings) -> None:
    left = list(seen.robots)
    for robot in truth.robots:
        score.robots += 1
        near = [other for other in left if math.hypot(other.x_m - robot.x_m, other.y_m - robot.y_m) < MATCH_M]
        if not near:
            continue
        best = min(near, key=lambda other: math.hypot(other.x_m - robot.x_m, other.y_m - robot.y_m))
        left.remove(best)
        score.found += 1
        score.right_id += (best.team, best.id) == (robot.team, robot.id)
        score.wrong_id += best.id is not None and (best.team, best.id) != (robot.team, robot.id)
        errors = [best.x_m - robot.x_m, best.y_m - robot.y_m]
        score.position_m += errors
        score.position_ratio += [error / best.position_sd_m for error in errors]
        if best.heading_rad is not None and best.heading_sd_rad is not None:
            turn = wrap_angle(best.heading_rad - robot.heading_rad)
            score.heading_rad.append(turn)
            score.heading_ratio.append(turn / best.heading_sd_rad)
    score.false += len(left)


def _count_ball(score: Score, truth: Truth, seen: Sightings) -> None:
    ball = truth.ball
    near = [other for other in seen.balls if math.hypot(other.x_m - ball.x_m, other.y_m - ball.y_m) < MATCH_M]
    score.balls_false += len(seen.balls) - len(near[:1])
    if ball.visible_share < HALF:
        return
    score.balls += 1
    if near:
        score.balls_found += 1
        errors = [near[0].x_m - ball.x_m, near[0].y_m - ball.y_m]
        score.ball_ratio += [error / near[0].position_sd_m for error in errors]
        if ball.visible_share > WHOLE:
            score.ball_m += errors


def _summary(score: Score) -> list[tuple[str, Row]]:
    def row(value: float, unit: str = "") -> Row:
        return {"value": value, "unit": unit}

    return [
        ("recall", row(round(score.found / score.robots, 5))),
        ("ids right", row(round(score.right_id / max(score.found, 1), 5))),
        ("ids wrong", row(score.wrong_id)),
        ("false robots", row(score.false)),
        ("position rms per axis", row(round(_rms(score.position_m) * 1e3, 3), "mm")),
        ("heading rms", row(round(math.degrees(_rms(score.heading_rad)), 3), "deg")),
        ("robot NEES", row(round(_rms(score.position_ratio) ** 2, 2))),
        ("heading NEES", row(round(_rms(score.heading_ratio) ** 2, 2))),
        ("ball recall", row(round(score.balls_found / max(score.balls, 1), 5))),
        ("false balls", row(score.balls_false)),
        ("ball rms per axis", row(round(_rms(score.ball_m) * 1e3, 3), "mm")),
        ("ball NEES", row(round(_rms(score.ball_ratio) ** 2, 2))),
    ]


def _at_rest(size: str) -> list[tuple[str, Row]]:
    """Scatter of sightings of things that do not move, at many places."""
    places: dict[tuple[int, Key], list[tuple[float, float, float]]] = {}
    balls: dict[int, list[tuple[float, float]]] = {}
    for seed in range(REST_SEEDS):
        settings = settings_of(
            size, {"synthetic.speed_m_s": 0.0, "synthetic.seed": seed, "synthetic.walking_people": 0}
        )
        for truth, seen in perceived(settings, REST_FRAMES):
            for robot in seen.robots:
                if robot.heading_rad is not None:
                    places.setdefault((seed, (robot.team, robot.id)), []).append(_pose(robot))
            if seen.balls and truth.ball.visible_share > WHOLE:
                balls.setdefault(seed, []).append((seen.balls[0].x_m, seen.balls[0].y_m))
    robots = [np.array(poses) for poses in places.values() if len(poses) > REST_FRAMES / 2]
    position = math.sqrt(float(np.mean([poses[:, :2].var(axis=0, ddof=1).mean() for poses in robots]))) * 1e3
    heading = math.degrees(math.sqrt(float(np.mean([_turns(poses).var(ddof=1) for poses in robots]))))
    scatter = [np.array(places_m).var(axis=0, ddof=1).mean() for places_m in balls.values()]
    ball = math.sqrt(float(np.mean(scatter))) * 1e3
    judged = size == "1280x1024"
    return [
        ("robot noise", _judged(position, "mm", ROBOT_NOISE_MM if judged else None)),
        ("heading noise", _judged(heading, "deg", HEADING_NOISE_DEG if judged else None)),
        ("ball noise", _judged(ball, "mm", BALL_NOISE_MM if judged else None)),
    ]


def _pose(robot: RobotSighting) -> tuple[float, float, float]:
    assert robot.heading_rad is not None
    return robot.x_m, robot.y_m, robot.heading_rad


def _turns(poses: Any) -> Any:
    """Headings relative to the first one."""
    return np.array([wrap_angle(heading - poses[0, 2]) for heading in poses[:, 2].tolist()])


def _judged(value: float, unit: str, goal: float | None) -> Row:
    row: Row = {"value": round(value, 4), "unit": unit}
    return row if goal is None else row | {"goal": f"<= {goal:g} {unit}", "met": value <= goal}


def _rms(errors: list[float]) -> float:
    return math.sqrt(sum(error * error for error in errors) / max(len(errors), 1))
