"""What is recognized in rendered pictures is what stands in the scene, to the pixel."""

import math

import numpy as np
import pytest

from tests.capture.synthetic.scenes import plain_settings
from tests.onboard.scenes import Lab
from vision_core.client.comparison import fold
from vision_core.client.recognition import RENDERED, find_rim, paper_geometry, recognize
from vision_core.models.mirror import MM_PER_M
from vision_core.onboard.overlay import draw_recognized
from vision_core.onboard.truth import first_solids
from vision_core.protocol.edge_codes import edge_codes

pytestmark = pytest.mark.slow  # renders whole pictures

TEAM_LETTERS = np.array([chr(code) for code in edge_codes()["team"]])
POSES = (
    ((-0.3, 0.2, 0.4), (0.2, 0.3, 1.0), (0.5, -0.4, 2.0), (-0.9, 0.5, 0.0), (-0.6, -0.5, 3.0), (0.9, 0.6, 1.0)),
    ((0.8, -0.3, 2.0), (0.3, -0.5, 1.0), (0.9, 0.4, 2.0), (-0.5, 0.3, 0.0), (1.1, -0.8, 3.0), (-0.2, -0.2, 1.0)),
)
BALL = (0.3, -0.1)


@pytest.fixture(scope="module")
def lab() -> Lab:
    return Lab(plain_settings(synthetic__robots_per_team=3, synthetic__walking_people=0))


@pytest.mark.parametrize("poses", POSES)
def test_edges_and_ball_of_a_match(lab: Lab, poses: tuple[tuple[float, float, float], ...]) -> None:
    scene = lab.scene(*poses, ball=BALL)
    picture = lab.camera.picture(scene)
    geometry = paper_geometry(
        lab.mirror,
        nearest_mm=MM_PER_M * lab.camera.nearest_floor_m,
        ball_radius_mm=MM_PER_M * lab.camera.settings.ball.radius_m,
    )
    seen = recognize(picture, geometry, RENDERED)
    truth = first_solids(scene, np.arange(360.0))
    letters = fold(TEAM_LETTERS[truth.kinds])
    px = np.maximum(lab.mirror.px_from_mm(truth.foot_mm), geometry.nearest_px)
    same = np.any([seen.letters == np.roll(letters, shift) for shift in (-1, 0, 1)], axis=0)
    assert same.mean() > 0.97
    assert {"x", "y", "w"} <= set(letters.tolist())
    off = np.min([np.abs(seen.radii_px - np.roll(px, shift)) for shift in (-1, 0, 1)], axis=0)
    assert np.median(off) < 0.4
    assert np.quantile(off, 0.95) < 1.5
    distance = math.hypot(BALL[0] - poses[0][0], BALL[1] - poses[0][1])
    direction = math.degrees(math.atan2(BALL[1] - poses[0][1], BALL[0] - poses[0][0]) - poses[0][2])
    assert seen.ball.px == pytest.approx(lab.mirror.px_from_mm(MM_PER_M * distance), abs=1.5)
    assert (seen.ball.direction_deg - direction + 180.0) % 360.0 - 180.0 == pytest.approx(0.0, abs=1.0)
    size = 2.0 * math.degrees(math.asin(lab.camera.settings.ball.radius_m / distance))
    assert seen.ball.size_deg == pytest.approx(size, abs=2.0)
    drawn = draw_recognized(picture, seen, geometry)
    assert drawn.shape == (720, 960, 3)


def test_the_rim_of_a_rendered_mirror(lab: Lab) -> None:
    rim = find_rim(lab.camera.picture(lab.scene(*POSES[0], ball=BALL)))
    assert (rim.column, rim.row) == pytest.approx((159.5, 119.5), abs=0.15)
    assert rim.radius_px == pytest.approx(lab.camera.rim_px * lab.camera.scale, abs=1.0)
