"""Accuracy of the pipeline, from pixels to sightings, against the ground truth of the simulated camera.

The simulated camera renders a match to pixels; the pipeline detects robots and ball from the pixels alone, and the
truth only scores the result. Three image sizes, 10 and 22 robots, five conditions of light, noise and motion. Sightings
are scored one by one, before the tracker smooths them.

A robot is found when a sighting lies within 5 cm of it; its id is right when team and id agree. The ball counts where
at least half of it is visible; its errors where all of it is. Errors of position are RMS per axis [mm], of heading RMS
[deg]. NEES is the mean squared error over the variance that the sighting claims, per degree of freedom: 1 is
consistent, more is overconfident.

*At rest* nothing moves: the noise is the standard deviation of an object's sightings about their mean, over several
places; the goals hold at 1280x1024. The baseline of everything is the truth itself.
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
WHOLLY_VISIBLE, HALF_VISIBLE = 0.99, 0.5
"""Visible shares of the ball."""
SIZES = {"640x480": (640, 480, 700.0), "1280x1024": (1280, 1024, 1420.0), "2048x1536": (2048, 1536, 2200.0)}
"""Width, height and focal length [px]."""
CONDITIONS: dict[str, dict[str, Any]] = {
    "default": {},
    "doubled noise": {"synthetic.read_noise": 3.0, "synthetic.shot_noise": 0.32},
    "40 % light, colors.light.adapt": {"synthetic.brightness": 0.4, "colors.light.adapt": True},
    "40 % light": {"synthetic.brightness": 0.4},
    "3 m/s, 10 ms exposure": {"synthetic.speed_m_s": 3.0, "synthetic.exposure_ms": 10.0},
}
TEAMS = {10: 5, 22: 11}
"""Number of robots, and robots per team."""
FRAMES = {"640x480": 600, "1280x1024": 300, "2048x1536": 150}
REST_SEEDS, REST_FRAMES = 6, 25
ROBOT_NOISE_MM, HEADING_NOISE_DEG, BALL_NOISE_MM = 0.08, 0.07, 0.10
"""Goals at 1280x1024."""

Key = tuple[Team, int | None]


@dataclass
class Score:
    """Counts and errors over all frames."""

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
    """Of a wholly visible ball, per axis."""
    position_ratio: list[float] = field(default_factory=list)
    """Errors over the standard deviations that the sightings claim."""
    heading_ratio: list[float] = field(default_factory=list)
    ball_ratio: list[float] = field(default_factory=list)


def run() -> list[Row]:
    """Score every size, number of robots and condition."""
    rows: list[Row] = []
    for size, frames in FRAMES.items():
        for robots, per_team in TEAMS.items():
            for condition, options in CONDITIONS.items():
                settings = settings_of(size, {"synthetic.robots_per_team": per_team} | options)
                score = score_settings(settings, frames)
                rows += [{"name": f"{size}, {robots} robots, {condition}: {key}"} | row for key, row in _summary(score)]
    for size in SIZES:
        rows += [{"name": f"{size}, at rest: {key}"} | row for key, row in _at_rest(size)]
    return rows


def settings_of(size: str, options: dict[str, Any]) -> Settings:
    """The default settings at another size, with further options."""
    width, height, focal = SIZES[size]
    center = [width / 2.0 - 2.9, height / 2.0 + 2.6]
    camera = {"width_px": width, "height_px": height, "pinhole.focal_px": focal, "pinhole.center_px": center}
    return load_settings(options={f"camera.{key}": value for key, value in camera.items()} | options)


def score_settings(settings: Settings, frames: int) -> Score:
    """Score a number of frames."""
    score = Score()
    for truth, sightings in perceived(settings, frames):
        _count_robots(score, truth, sightings)
        _count_ball(score, truth, sightings)
    return score


def perceived(settings: Settings, frames: int) -> list[tuple[Truth, Sightings]]:
    """Render and perceive a number of frames. Returns truth and sightings of each."""
    clock, camera = MonotonicClock(), CameraSetup.from_settings(settings)
    source = open_source(settings, camera, clock, paced=False)
    assert isinstance(source, SyntheticCamera)
    perception = Perception(settings, camera)
    perception.warm_up()
    pixels = camera.black_image()
    pairs = []
    for number in range(1, frames + 1):
        grabbed = source.grab(pixels)
        sightings = perception.perceive(ImageFrame(camera.name, number, grabbed, pixels), clock)
        pairs.append((source.truth, sightings.record()))
    source.close()
    return pairs


def _count_robots(score: Score, truth: Truth, sightings: Sightings) -> None:
    unmatched = list(sightings.robots)
    for robot in truth.robots:
        score.robots += 1
        near = [other for other in unmatched if math.hypot(other.x_m - robot.x_m, other.y_m - robot.y_m) < MATCH_M]
        if not near:
            continue
        best = min(near, key=lambda other: math.hypot(other.x_m - robot.x_m, other.y_m - robot.y_m))
        unmatched.remove(best)
        score.found += 1
        score.right_id += (best.team, best.id) == (robot.team, robot.id)
        score.wrong_id += best.id is not None and (best.team, best.id) != (robot.team, robot.id)
        errors = [best.x_m - robot.x_m, best.y_m - robot.y_m]
        score.position_m += errors
        score.position_ratio += [error / best.position_sd_m for error in errors]
        if best.heading_rad is not None and best.heading_sd_rad is not None:
            error = wrap_angle(best.heading_rad - robot.heading_rad)
            score.heading_rad.append(error)
            score.heading_ratio.append(error / best.heading_sd_rad)
    score.false += len(unmatched)


def _count_ball(score: Score, truth: Truth, sightings: Sightings) -> None:
    ball = truth.ball
    near = [other for other in sightings.balls if math.hypot(other.x_m - ball.x_m, other.y_m - ball.y_m) < MATCH_M]
    score.balls_false += len(sightings.balls) - len(near[:1])
    if ball.visible_share < HALF_VISIBLE:
        return
    score.balls += 1
    if near:
        score.balls_found += 1
        errors = [near[0].x_m - ball.x_m, near[0].y_m - ball.y_m]
        score.ball_ratio += [error / near[0].position_sd_m for error in errors]
        if ball.visible_share > WHOLLY_VISIBLE:
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
    """Noise of the sightings of robots and balls that do not move, at several places."""
    places: dict[tuple[int, Key], list[tuple[float, float, float]]] = {}
    balls: dict[int, list[tuple[float, float]]] = {}
    for seed in range(REST_SEEDS):
        settings = settings_of(
            size, {"synthetic.speed_m_s": 0.0, "synthetic.seed": seed, "synthetic.walking_people": 0}
        )
        for truth, sightings in perceived(settings, REST_FRAMES):
            for robot in sightings.robots:
                if robot.heading_rad is not None:
                    places.setdefault((seed, (robot.team, robot.id)), []).append(_pose(robot))
            if sightings.balls and truth.ball.visible_share > WHOLLY_VISIBLE:
                balls.setdefault(seed, []).append((sightings.balls[0].x_m, sightings.balls[0].y_m))
    robots = [np.array(poses) for poses in places.values() if len(poses) > REST_FRAMES / 2]
    position = math.sqrt(float(np.mean([poses[:, :2].var(axis=0, ddof=1).mean() for poses in robots]))) * 1e3
    heading = math.degrees(math.sqrt(float(np.mean([_relative_headings(poses).var(ddof=1) for poses in robots]))))
    scatter = [np.array(places_m).var(axis=0, ddof=1).mean() for places_m in balls.values()]
    ball = math.sqrt(float(np.mean(scatter))) * 1e3
    has_goal = size == "1280x1024"
    return [
        ("robot noise", _goal_row(position, "mm", ROBOT_NOISE_MM if has_goal else None)),
        ("heading noise", _goal_row(heading, "deg", HEADING_NOISE_DEG if has_goal else None)),
        ("ball noise", _goal_row(ball, "mm", BALL_NOISE_MM if has_goal else None)),
    ]


def _pose(robot: RobotSighting) -> tuple[float, float, float]:
    assert robot.heading_rad is not None
    return robot.x_m, robot.y_m, robot.heading_rad


def _relative_headings(poses: Any) -> Any:
    """Headings relative to the first one [rad], shape (n,)."""
    return np.array([wrap_angle(heading - poses[0, 2]) for heading in poses[:, 2].tolist()])


def _goal_row(value: float, unit: str, goal: float | None) -> Row:
    row: Row = {"value": round(value, 4), "unit": unit}
    return row if goal is None else row | {"goal": f"<= {goal:g} {unit}", "met": value <= goal}


def _rms(errors: list[float]) -> float:
    return math.sqrt(sum(error * error for error in errors) / max(len(errors), 1))
