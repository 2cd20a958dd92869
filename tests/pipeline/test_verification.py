"""Known robots are verified where they should be: what is seen is what a search of each frame alone shows."""

import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import Phase, given, settings
from hypothesis import strategies as st

from bench.segmentation import SIZES
from tests.objects.drawing import CODES, SETTINGS, Picture
from vision_core.capture.synthetic.camera import SyntheticCamera
from vision_core.clock import Instant, ManualClock
from vision_core.color.light import NEUTRAL_LIGHT
from vision_core.geometry import Bytes
from vision_core.models.camera_setup import CameraSetup
from vision_core.native.opencv import read_picture
from vision_core.pipeline.perception import Perception
from vision_core.settings.schema import Settings
from vision_core.types.image import ImageFrame
from vision_core.types.objects import RobotSighting, Sightings, Team
from vision_core.venues.loader import load_settings

GAP_NS = 33_000_000
CAMERA = CameraSetup.from_settings(SETTINGS)
Pose = tuple[str, int, float, float, float]
"""Team, id, x, y [m], heading [rad]."""
A, B = ("blue", 3, -0.4, 0.2, 0.3), ("blue", 7, 0.3, -0.3, 2.0)


class Film:
    """Pictures 33 ms apart, each perceived after those before and alone."""

    def __init__(self, of: Settings, lit: bool = True) -> None:
        camera = CameraSetup.from_settings(of)
        self.following, self.alone = Perception(of, camera), Perception(of, camera)
        self.number = 0
        if not lit:  # what is drawn here is no field whose light could be measured
            for perception in (self.following, self.alone):
                perception.lighting.hold(NEUTRAL_LIGHT)

    def show(self, pixels: Bytes) -> tuple[Sightings, Sightings]:
        """What is seen after the pictures before, and what is seen of this one alone."""
        self.number += 1
        frame = ImageFrame("main", self.number, Instant(self.number * GAP_NS), pixels)
        after = self.following.perceive(frame, ManualClock()).record()
        return after, self.alone.perceive_alone(frame, ManualClock()).record()

    @property
    def has_searched(self) -> bool:
        """Have blobs of a robot been looked at?"""
        blobs = self.following.blobs[: self.following.blob_count]
        return bool(np.isin(blobs["color"], [self.following.table.index(team) for team in Team]).any())


def drawn(*poses: Pose, ball: tuple[float, float] = (0.0, 0.5)) -> Bytes:
    picture = Picture(CAMERA.model, *CAMERA.size_px)
    for team, number, x_m, y_m, heading_rad in poses:
        picture.paint_robot(team, CODES[number], x_m, y_m, heading_rad)
    picture.paint_ball(*ball)
    return picture.as_bytes()


def names(seen: Sightings) -> list[tuple[str, int | None]]:
    return [(robot.team, robot.id) for robot in seen.robots]


def off_by(one: RobotSighting, other: RobotSighting) -> float:
    """Distance of two sightings, in standard deviations of both."""
    apart = math.dist((one.x_m, one.y_m), (other.x_m, other.y_m))
    return apart / math.hypot(one.position_sd_m, other.position_sd_m)


@pytest.mark.slow
@settings(
    deadline=None, max_examples=12, phases=[Phase.generate], derandomize=True
)  # limits of shares, not of each case
@given(st.integers(0, 10_000), st.sampled_from(list(SIZES)), st.sampled_from([0.0, 8.0]))
def test_a_match_is_seen_as_by_searching_every_frame(seed: int, size: str, exposure_ms: float) -> None:
    options = {**SIZES[size], "synthetic.seed": seed, "synthetic.exposure_ms": exposure_ms}
    of = load_settings(options=options)
    camera = SyntheticCamera(of, CameraSetup.from_settings(of), ManualClock(), paced=False)
    pixels, film, off, searched = CameraSetup.from_settings(of).black_image(), Film(of), [], 0
    for _ in range(30):
        camera.grab(pixels)
        after, alone = film.show(pixels)
        assert names(after) == names(alone)
        assert after.balls[:1] == alone.balls[:1]
        off += [off_by(one, other) for one, other in zip(after.robots, alone.robots, strict=True)]
        searched += film.has_searched
    assert np.quantile(off, 0.5) < 1.0
    assert np.quantile(off, 0.95) < 3.0
    assert max(off) < 8.0
    # some frames are searched for the ball; where 8 ms smear a dot over more than ten pixels, robots are searched too
    assert searched <= 20 or exposure_ms > 0.0


def test_a_robot_that_was_swapped_by_hand_has_its_own_id_at_once() -> None:
    film = Film(SETTINGS, lit=False)
    for _ in range(3):
        after, _ = film.show(drawn(A, B))
    assert names(after) == [("blue", 3), ("blue", 7)]
    assert not film.has_searched
    after, alone = film.show(drawn(("blue", 5, *A[2:]), B))
    assert names(after) == names(alone) == [("blue", 5), ("blue", 7)]
    assert film.has_searched


def test_two_robots_that_change_places_keep_their_ids() -> None:
    film = Film(SETTINGS, lit=False)
    for turn in range(8):
        one, other = (A, B) if turn % 2 else ((*A[:2], *B[2:]), (*B[:2], *A[2:]))
        after, alone = film.show(drawn(one, other))
        assert names(after) == names(alone) == [("blue", 3), ("blue", 7)]
        for robot, pose in zip(after.robots, (one, other), strict=True):
            assert math.dist((robot.x_m, robot.y_m), pose[2:4]) < 0.002


@pytest.mark.parametrize("hides", ["a dot", "the whole robot"])
def test_a_covered_robot_is_no_longer_verified(hides: str) -> None:
    film = Film(SETTINGS, lit=False)
    for _ in range(3):
        film.show(drawn(A, B))
    covered = Picture(CAMERA.model, *CAMERA.size_px)
    for team, number, x_m, y_m, heading_rad in (A, B):
        covered.paint_robot(team, CODES[number], x_m, y_m, heading_rad)
    covered.paint_ball(0.0, 0.5)
    radius_m, ahead_m = (0.02, 0.065) if hides == "a dot" else (0.09, 0.0)
    turn = A[4] + math.atan2(0.055, 0.035)  # to the front left dot
    x_m, y_m = A[2] + ahead_m * math.cos(turn), A[3] + ahead_m * math.sin(turn)
    covered.paint_disc("white", x_m, y_m, radius_m, SETTINGS.robots.height_m)
    assert not film.has_searched
    after, _ = film.show(covered.as_bytes())
    assert film.has_searched == (hides == "a dot")
    # one that lacks a dot is held by its shape (confirmation)
    assert (("blue", 3) in names(after)) == (hides == "a dot")


def test_a_fast_robot_is_verified_and_one_that_brakes_is_found() -> None:
    film = Film(SETTINGS, lit=False)
    for step in range(12):
        x_m = -0.8 + 0.1 * min(step, 7)  # 3 m/s, then it stands
        after, alone = film.show(drawn(("yellow", 4, x_m, 0.1, 0.1 * step)))
        assert names(after) == names(alone) == [("yellow", 4)]
        assert off_by(after.robots[0], alone.robots[0]) < 4.0
        if 3 <= step <= 7 or step >= 11:
            assert not film.has_searched, step


FOLDERS = {
    "vsss-larc": "captura_2.png",
    "vsss-rodetas": "*",
    "sdp-2016": "*",
    "mirosot-agh-b": "*",
    "ssl-rosenheim": "*",
}


@pytest.mark.slow
@pytest.mark.parametrize("venue", FOLDERS)
def test_a_real_picture_shown_as_a_film_stays_what_it_is(real_pictures: Path, venue: str) -> None:
    files = sorted((real_pictures / venue).glob(FOLDERS[venue]))
    pictures = [file for file in files if file.suffix in {".png", ".jpg"}][:3]
    assert pictures
    of = load_settings(venue)
    for file in pictures:
        film, pixels = Film(of), read_picture(file)
        for _ in range(4):
            after, alone = film.show(pixels)
            assert names(after) == names(alone), file.name
            for one, other in zip(after.robots, alone.robots, strict=True):
                assert math.dist((one.x_m, one.y_m), (other.x_m, other.y_m)) < max(0.005, 3.0 * other.position_sd_m)
