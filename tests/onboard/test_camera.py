"""The camera in a match: the same seed is the same match, and what it does not accept is refused."""

from itertools import islice

import numpy as np
import pytest

from vision_core.capture.synthetic.world import World
from vision_core.errors import SettingsError
from vision_core.geometry import Bytes
from vision_core.onboard.camera import RATE_HZ, OnboardCamera
from vision_core.types.objects import Team
from vision_core.venues.loader import load_settings

SIZE = (120, 90)


def film(seed: int, frames: int = 3) -> list[Bytes]:
    settings = load_settings(options={"synthetic.seed": seed})
    camera = OnboardCamera(settings, (Team.YELLOW, 2), size_px=SIZE)
    return [picture for _, picture in islice(camera.video(World(settings)), frames)]


def test_equal_seeds_give_equal_videos() -> None:
    first, again, other = film(7), film(7), film(8)
    assert all((a == b).all() for a, b in zip(first, again, strict=True))
    assert all((a != b).any() for a, b in zip(first, other, strict=True))
    assert (first[0] != first[1]).any()


def test_the_video_follows_the_match_at_its_rate() -> None:
    settings = load_settings()
    camera = OnboardCamera(settings, (Team.BLUE, 1), size_px=SIZE)
    snapshots = [snapshot for snapshot, _ in islice(camera.video(World(settings)), 4)]
    world = World(settings)
    world.advance(3.0 / RATE_HZ)
    np.testing.assert_allclose(snapshots[3].robots, world.snapshot().robots, atol=1e-9)


def test_noise_is_that_of_the_settings() -> None:
    settings = load_settings(options={"synthetic.read_noise": 4.0, "synthetic.shot_noise": 0.0})
    camera = OnboardCamera(settings, (Team.BLUE, 1), size_px=(320, 240))
    scene = camera.scene(World(settings).snapshot())
    difference = camera.picture(scene).astype(float) - camera.exact_picture(scene)
    assert difference[:20, :60].std() == pytest.approx(4.0, rel=0.05)


@pytest.mark.parametrize(("robot", "size_px"), [((Team.BLUE, 9), SIZE), ((Team.BLUE, 0), SIZE)])
def test_a_robot_that_does_not_play_has_no_camera(robot: tuple[Team, int], size_px: tuple[int, int]) -> None:
    with pytest.raises(SettingsError, match="blue:1, blue:2"):
        OnboardCamera(load_settings(), robot, size_px=size_px)


@pytest.mark.parametrize("size_px", [(320, 20), (9000, 240)])
def test_sizes_have_limits(size_px: tuple[int, int]) -> None:
    with pytest.raises(SettingsError, match="60..4096"):
        OnboardCamera(load_settings(), (Team.BLUE, 1), size_px=size_px)
