"""What the camera says for scoring agrees with the world, in the image and out of it."""

import math

import numpy as np
import pytest

from tests.capture.synthetic.scenes import plain_settings, scene
from vision_core.capture.synthetic.truth import truth_of, visible_share
from vision_core.clock import Instant
from vision_core.models.camera_setup import CameraSetup
from vision_core.types.objects import Team


def test_it_names_every_robot_and_whether_it_is_wholly_in_the_picture() -> None:
    settings = plain_settings()
    shown = scene((0.3, -0.2, 4.0), (1.65, 0.0, 0.0), (40.0, 0.0, 0.0), ball=(0.5, 0.1))
    worn = ((Team.BLUE, 3), (Team.YELLOW, 3), (Team.YELLOW, 0))
    truth = truth_of(Instant(9), shown, worn, CameraSetup.from_settings(settings), settings)
    assert [(robot.team, robot.id, robot.in_picture) for robot in truth.robots] == [
        ("blue", 3, True), ("yellow", 3, False), ("yellow", 0, False),
    ]  # fmt: skip
    assert (truth.robots[0].x_m, truth.robots[0].y_m) == (0.3, -0.2)
    assert truth.robots[0].heading_rad == pytest.approx(4.0 - math.tau)
    assert (truth.instant, truth.ball.x_m, truth.ball.visible_share) == (9, 0.5, 1.0)


def test_a_ball_at_the_images_edge_is_partly_visible() -> None:
    settings = plain_settings()
    camera = CameraSetup.from_settings(settings)
    x, y = camera.model.field_from_pixel(np.array([(-0.5, 240.0)]), settings.ball.radius_m)[0]
    assert visible_share(scene((0.0, 0.0), ball=(x, y)), camera, settings) == pytest.approx(0.5, abs=0.1)
    assert visible_share(scene((0.0, 0.0), ball=(x - 0.1, y)), camera, settings) == 0.0
