"""The whole way from pixels to tracks against the truth of the synthetic camera.

The world is rendered to pixels and detected from pixels; the truth is used only to score. A robot counts
as found when a sighting lies within 5 cm of it; its id is right when team and id agree. Position, heading
and ball errors are those of single sightings, without the tracker's smoothing; the ball counts where at
least half of it can be seen.
"""

import math
import time
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from vision_core.capture.source import open_source
from vision_core.capture.synthetic.camera import SyntheticCamera
from vision_core.capture.synthetic.truth import Truth
from vision_core.clock import MonotonicClock
from vision_core.geometry import wrap_angle
from vision_core.settings import Settings
from vision_core.settings_files import load_settings
from vision_core.tasks.perception import Perception
from vision_core.types.image import ImageFrame
from vision_core.types.objects import Sightings

FRAMES = 1000
MATCH_M = 0.05
WHOLE = 0.99
HALF = 0.5
SIZES: dict[str, dict[str, Any]] = {
    "640x480": {},
    "1280x1024": {
        "camera.width_px": 1280,
        "camera.height_px": 1024,
        "camera.pinhole.focal_px": 1420.0,
        "camera.pinhole.center_px": [637.1, 514.6],
    },
}


@dataclass
class Score:
    """What was counted over all frames."""

    robots: int = 0
    found: int = 0
    right_id: int = 0
    false: int = 0
    balls: int = 0
    balls_found: int = 0
    balls_false: int = 0
    position_m: list[float] = field(default_factory=list)
    heading_rad: list[float] = field(default_factory=list)
    ball_m: list[float] = field(default_factory=list)
    """Errors of a ball that is wholly visible."""
    half_ball_m: list[float] = field(default_factory=list)
    """Errors of a ball that is partly hidden, at most by half: its visible part lies off its center."""
    seconds: list[float] = field(default_factory=list)


def run(frames: int = FRAMES) -> list[dict[str, Any]]:
    """Score every size; returns the rows of the table."""
    rows = []
    for name, options in SIZES.items():
        score = score_settings(load_settings(options=options), frames)
        rows += [{"name": f"{name}: {key}", "value": value, "unit": unit} for key, value, unit in summary(score)]
    return rows


def score_settings(settings: Settings, frames: int) -> Score:
    """Render and perceive a number of frames."""
    clock = MonotonicClock()
    source = open_source(settings, clock, paced=False)
    assert isinstance(source, SyntheticCamera)
    perception = Perception(settings)
    perception.warm_up()
    pixels = np.empty((settings.camera.height_px, settings.camera.width_px, 3), dtype=np.uint8)
    score = Score()
    for number in range(1, frames + 1):
        grabbed = source.grab(pixels)
        began = time.perf_counter()
        seen = perception.perceive(ImageFrame(settings.camera.name, number, grabbed, pixels), clock)
        score.seconds.append(time.perf_counter() - began)
        _count_robots(score, source.truth, seen)
        _count_ball(score, source.truth, seen)
    source.close()
    return score


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
        score.position_m += [best.x_m - robot.x_m, best.y_m - robot.y_m]
        if best.heading_rad is not None:
            score.heading_rad.append(wrap_angle(best.heading_rad - robot.heading_rad))
        score.right_id += (best.team, best.id) == (robot.team, robot.id)
    score.false += len(left)


def _count_ball(score: Score, truth: Truth, seen: Sightings) -> None:
    ball = truth.ball
    near = [other for other in seen.balls if math.hypot(other.x_m - ball.x_m, other.y_m - ball.y_m) < MATCH_M]
    score.balls_false += len(seen.balls) - len(near[:1])
    if ball.visible_share >= HALF:
        score.balls += 1
        if near:
            score.balls_found += 1
            errors = score.ball_m if ball.visible_share > WHOLE else score.half_ball_m
            errors += [near[0].x_m - ball.x_m, near[0].y_m - ball.y_m]


def summary(score: Score) -> list[tuple[str, float, str]]:
    """The figures of a score: name, value, unit."""
    return [
        ("robots", score.robots, ""),
        ("recall", round(score.found / score.robots, 5), ""),
        ("id correctness", round(score.right_id / max(score.found, 1), 5), ""),
        ("false robots", score.false, ""),
        ("position rms per axis", round(_rms(score.position_m) * 1e3, 3), "mm"),
        ("heading rms", round(math.degrees(_rms(score.heading_rad)), 3), "deg"),
        ("balls at least half visible", score.balls, ""),
        ("ball recall", round(score.balls_found / max(score.balls, 1), 5), ""),
        ("false balls", score.balls_false, ""),
        ("ball rms per axis, wholly visible", round(_rms(score.ball_m) * 1e3, 3), "mm"),
        ("ball rms per axis, up to half hidden", round(_rms(score.half_ball_m) * 1e3, 3), "mm"),
        ("perception, median", round(float(np.median(score.seconds)) * 1e3, 3), "ms"),
    ]


def _rms(errors: list[float]) -> float:
    return math.sqrt(sum(error * error for error in errors) / max(len(errors), 1))
