"""Covariances are consistent: normalized errors of simulated matches (NEES), and what calibration adds."""

import math

import numpy as np
import pytest
from msgspec.structs import replace

from vision_core.clock import Instant, after
from vision_core.geometry import Floats
from vision_core.tracks.filters import density_from_acceleration, start_variance
from vision_core.tracks.tracker import Tracker
from vision_core.types.objects import BallSighting, RobotSighting, Sightings, Team
from vision_core.types.tables import SightingsTable
from vision_core.types.tracks import World
from vision_core.venues.loader import load_settings

SETTINGS = load_settings()
START = Instant(5_000_000_000)
RULES = SETTINGS.tracks
MOTIONS = (RULES.robot_acceleration_m_s2, RULES.robot_turn_acceleration_rad_s2, RULES.ball_acceleration_m_s2)
SD = (0.0005, 0.004, 0.002)
"""Standard deviations of the sightings: position, heading, ball [m, rad, m], without the calibration's."""
ADDED = (RULES.robot_noise_m, RULES.heading_noise_rad, RULES.ball_noise_m)


class Walk:
    """White-noise acceleration, the same on several axes: the tracker's own model."""

    def __init__(self, rng: np.random.Generator, axes: int, acceleration: float, t: float) -> None:
        density = density_from_acceleration(acceleration)
        self.shake = np.linalg.cholesky(density * np.array([[t**3 / 3.0, t**2 / 2.0], [t**2 / 2.0, t]]))
        self.state = np.stack([np.zeros(axes), rng.normal(0.0, math.sqrt(start_variance(acceleration)), axes)])
        self.step, self.rng = np.array([[1.0, t], [0.0, 1.0]]), rng

    def next(self) -> Floats:
        self.state = self.step @ self.state + self.shake @ self.rng.normal(size=self.state.shape)
        place: Floats = self.state[0].copy()
        return place


def normalized(world: World, place: Floats, heading: float, ball: Floats) -> tuple[float, float, float]:
    (robot,), seen = world.robots, world.ball
    assert seen is not None
    return (
        float(((place - (robot.x_m, robot.y_m)) ** 2).mean()) / robot.position_sd_m**2,
        math.remainder(robot.heading_rad - heading, math.tau) ** 2 / robot.heading_sd_rad**2,
        float(((ball - (seen.x_m, seen.y_m)) ** 2).mean()) / seen.position_sd_m**2,
    )


@pytest.mark.parametrize("rate_hz", [10.0, 30.0, 200.0])
@pytest.mark.parametrize("ahead_s", [0.0, 0.05])
def test_errors_agree_with_the_covariances(rate_hz: float, ahead_s: float) -> None:
    # 50 ms ahead of the truth's next step the tracks are asked where the truth is then
    rng, squares, runs, frames = np.random.default_rng(3), [], 120, 20
    noises = [math.hypot(sd, added) for sd, added in zip(SD, ADDED, strict=True)]
    lead = max(1, round(ahead_s * rate_hz)) if ahead_s else 0
    for _ in range(runs):
        tracker = Tracker(replace(RULES, gate_m=2.0), SETTINGS.robots)
        walks = [Walk(rng, axes, a, 1.0 / rate_hz) for axes, a in zip((2, 1, 2), MOTIONS, strict=True)]
        truth = [[walk.next() for walk in walks] for _ in range(frames + lead)]
        for frame in range(frames):
            (x, y), (heading,), ball = (
                t + rng.normal(0.0, s, t.shape) for t, s in zip(truth[frame], noises, strict=True)
            )
            at = after(START, frame / rate_hz)
            robot = RobotSighting(Team.BLUE, 1, 0.0, 0.0, x, y, math.remainder(heading, math.tau), 0.9, SD[0], SD[1])
            balls = (BallSighting(0.0, 0.0, float(ball[0]), float(ball[1]), 0.9, SD[2]),)
            tracker.update(SightingsTable.of(Sightings("main", frame, at, at, (robot,), balls, True)))
            if frame < 3:
                continue  # a heading that turns by radians per frame is not yet one angle
            world = tracker.predict(after(at, lead / rate_hz)).record()
            place, (angle,), rolled = truth[frame + lead]
            squares.append(normalized(world, place, angle, rolled))
    measured = np.array(squares).reshape(runs, -1, 3).mean(axis=1)
    spread = measured.std(axis=0) / math.sqrt(runs)
    assert (np.abs(measured.mean(axis=0) - 1.0) < 4.0 * spread + 0.02).all(), (measured.mean(axis=0), spread)


def test_a_sighting_of_smaller_variance_has_more_weight() -> None:
    def last_place(sd_m: float) -> float:
        tracker = Tracker(RULES, SETTINGS.robots)
        for frame in range(60):
            x, sd = (0.0, 0.001) if frame < 59 else (0.01, sd_m)
            at = after(START, 0.005 * frame)
            robot = RobotSighting(Team.BLUE, 1, 0.0, 0.0, x, 0.0, 0.0, 0.9, sd, 0.01)
            world = tracker.update(SightingsTable.of(Sightings("main", frame, at, at, (robot,), (), True))).record()
        return world.robots[0].x_m

    places = [last_place(sd) for sd in (0.03, 0.01, 0.003, 0.001, 0.0)]
    assert places == sorted(places)
    assert places[-1] - places[-2] < 0.5 * 0.01  # calibration stays unsure however sharp the sighting is


def test_a_new_track_has_the_variance_of_sighting_and_calibration() -> None:
    tracker = Tracker(RULES, SETTINGS.robots)
    robot = RobotSighting(Team.BLUE, 1, 0.0, 0.0, 0.0, 0.0, 0.0, 0.9, 0.004, 0.02)
    ball = BallSighting(0.0, 0.0, 0.0, 0.0, 0.9, 0.003)
    world = tracker.update(SightingsTable.of(Sightings("main", 1, START, START, (robot,), (ball,), True))).record()
    assert world.ball is not None
    assert world.robots[0].position_sd_m == pytest.approx(math.hypot(0.004, RULES.robot_noise_m))
    assert world.robots[0].heading_sd_rad == pytest.approx(math.hypot(0.02, RULES.heading_noise_rad))
    assert world.ball.position_sd_m == pytest.approx(math.hypot(0.003, RULES.ball_noise_m))
