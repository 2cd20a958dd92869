"""Pictures painted by hand: lines are passed, walls and robots are not; turned and mirrored pictures; refusals."""

from dataclasses import replace

import numpy as np
import pytest

from vision_core.client.recognition import RENDERED, PictureGeometry, paper_geometry, recognize
from vision_core.errors import SourceError
from vision_core.geometry import Bytes, Floats, Mask
from vision_core.models.hyperboloid import Hyperboloid
from vision_core.models.mirror import PAPER_MIRROR
from vision_core.types.edges import Rgb

GEOMETRY = paper_geometry(PAPER_MIRROR, nearest_mm=110.0)
GREEN, WHITE, BLACK, BLUE, YELLOW = (40, 105, 50), (230, 234, 228), (30, 29, 30), (20, 90, 200), (235, 210, 40)
WALL_PX = 90.0


class Painting:
    """A picture in colors, by radius and direction of its pixels; it begins as floor within a white wall."""

    def __init__(self, geometry: PictureGeometry = GEOMETRY) -> None:
        width, height = geometry.size_px
        columns, rows = np.meshgrid(np.arange(float(width)), np.arange(float(height)))
        self.radius, self.direction = geometry.px_from_pixel(columns, rows)
        self.rgb: Floats = np.where((self.radius < WALL_PX)[..., None], GREEN, WHITE).astype(np.float64)

    def paint(self, where: Mask, color: Rgb) -> "Painting":
        self.rgb[where] = color
        return self

    def sector(self, first_deg: float, end_deg: float, from_px: float, to_px: float = 999.0) -> Mask:
        inside = (self.direction >= first_deg) & (self.direction < end_deg)
        return np.asarray(inside & (self.radius >= from_px) & (self.radius < to_px))

    @property
    def bgr(self) -> Bytes:
        return self.rgb[..., ::-1].astype(np.uint8)


def robot(painting: Painting, first_deg: float, foot_px: float, band: Rgb) -> Painting:
    """A dark robot 40 degrees wide with a band."""
    painting.paint(painting.sector(first_deg, first_deg + 40.0, foot_px, foot_px + 25.0), BLACK)
    return painting.paint(painting.sector(first_deg, first_deg + 40.0, foot_px + 5.0, foot_px + 15.0), band)


def test_the_wall_is_the_edge_and_its_radius_is_exact() -> None:
    seen = recognize(Painting().bgr, GEOMETRY, RENDERED)
    assert set(seen.letters.tolist()) == {"w"}
    assert np.abs(seen.radii_px - WALL_PX).max() < 0.6
    assert seen.ball.hidden


def test_lines_are_passed_across_along_and_slanted() -> None:
    painting = Painting()
    forward = painting.radius * np.cos(np.radians(painting.direction))
    left = painting.radius * np.sin(np.radians(painting.direction))
    for line in (np.abs(forward - 45.0), np.abs(left), np.abs(forward - left - 30.0), np.abs(painting.radius - 70.0)):
        painting.paint((line < 1.0) & (painting.radius < WALL_PX), WHITE)
    seen = recognize(painting.bgr, GEOMETRY, RENDERED)
    assert np.mean(np.abs(seen.radii_px - WALL_PX) < 2.0) > 0.97


def test_a_near_white_wall_is_no_line() -> None:
    painting = Painting()
    painting.paint(painting.sector(60.0, 140.0, 30.0), WHITE)
    seen = recognize(painting.bgr, GEOMETRY, RENDERED)
    assert np.abs(seen.radii_px[64:136] - 30.0).max() < 0.6


def test_a_dark_foot_is_a_robot_and_its_band_the_team() -> None:
    painting = robot(robot(Painting(), 20.0, 40.0, BLUE), 200.0, 60.0, YELLOW)
    painting.paint(painting.sector(100.0, 140.0, 50.0, 70.0), BLACK)
    seen = recognize(painting.bgr, GEOMETRY, RENDERED)
    assert set(seen.letters[24:56].tolist()) == {"x"}
    assert set(seen.letters[204:236].tolist()) == {"y"}
    assert set(seen.letters[104:136].tolist()) == {"r"}
    assert np.abs(seen.radii_px[24:56] - 40.0).max() < 0.7


def test_a_line_before_a_robot_is_not_the_robot() -> None:
    painting = robot(Painting(), 20.0, 60.0, BLUE)
    painting.paint(painting.sector(0.0, 90.0, 57.0, 60.0), WHITE)
    seen = recognize(painting.bgr, GEOMETRY, RENDERED)
    assert set(seen.letters[24:56].tolist()) == {"x"}
    assert np.abs(seen.radii_px[24:56] - 60.0).max() < 1.0


def test_color_from_the_foot_on_is_a_goal() -> None:
    painting = Painting()
    painting.paint(painting.sector(0.0, 40.0, 70.0), BLUE).paint(painting.sector(180.0, 220.0, 70.0), YELLOW)
    seen = recognize(painting.bgr, GEOMETRY, RENDERED)
    assert set(seen.letters[3:37].tolist()) == {"u"}
    assert set(seen.letters[183:217].tolist()) == {"v"}


def test_the_ball_is_told_where_it_stands_on_the_floor() -> None:
    painting = Painting()
    forward = painting.radius * np.cos(np.radians(painting.direction)) - 60.0
    left = painting.radius * np.sin(np.radians(painting.direction))
    painting.paint(np.hypot(forward, left) < 4.0, (250, 120, 30))
    flat = recognize(painting.bgr, GEOMETRY, RENDERED).ball
    assert (flat.px, flat.direction_deg) in {(59, 0), (60, 0)}
    assert flat.size_deg == pytest.approx(2.0 * np.degrees(np.arcsin(4.0 / 60.0)), abs=1.0)
    high = recognize(painting.bgr, replace(GEOMETRY, ball_radius_mm=21.35), RENDERED).ball
    seen_mm, height_mm = PAPER_MIRROR.mm_from_px(60.0), Hyperboloid.of(PAPER_MIRROR).height_mm
    stands_px = PAPER_MIRROR.px_from_mm(seen_mm * (1.0 - 21.35 / height_mm))  # seen farther out than it stands
    assert high.px == pytest.approx(stands_px, abs=1.0)
    assert high.px < flat.px - 2
    assert set(recognize(painting.bgr, GEOMETRY, RENDERED).letters.tolist()) == {"w"}


@pytest.mark.parametrize(("turn_deg", "mirrored", "at_deg"), [(90.0, False, 310.0), (0.0, True, 320.0)])
def test_turned_and_mirrored_pictures(turn_deg: float, mirrored: bool, at_deg: float) -> None:
    painting = robot(Painting(), 20.0, 40.0, BLUE)
    geometry = replace(GEOMETRY, turn_deg=turn_deg, mirrored=mirrored)
    seen = recognize(painting.bgr, geometry, RENDERED)
    middle = round((20.0 + 20.0 - turn_deg if not mirrored else -40.0) % 360.0)
    assert middle == at_deg
    assert set(seen.letters[np.arange(middle - 15, middle + 15) % 360].tolist()) == {"x"}
    columns, rows = geometry.pixel_from_px(np.array([30.0]), np.array([10.0]))
    radius, direction = geometry.px_from_pixel(columns, rows)
    assert radius[0] == pytest.approx(np.hypot(30.0, 10.0))
    assert direction[0] == pytest.approx(np.degrees(np.arctan2(10.0, 30.0)))


def test_a_view_of_it_is_a_clients_view() -> None:
    view = recognize(Painting().bgr, GEOMETRY, RENDERED, directions=90).view(PAPER_MIRROR, 1.5)
    assert (len(view.mm), view.time_s, view.directions_deg[1]) == (90, 1.5, 4.0)
    assert view.mm.mean() == pytest.approx(PAPER_MIRROR.mm_from_px(WALL_PX), rel=0.02)
    assert not view.mm.flags.writeable
    assert "ball hidden" in view.summary


@pytest.mark.parametrize(
    ("picture", "complaint"),
    [
        (np.zeros((240, 320, 3), dtype=np.uint8), "no floor"),
        (np.zeros((0, 0, 3), dtype=np.uint8), r"shape \(0, 0, 3\)"),
        (np.zeros((480, 640, 3), dtype=np.uint8), r"\(240, 320, 3\), blue green red"),
        (np.zeros((240, 320), dtype=np.uint8), r"shape \(240, 320\)"),
        (np.zeros((240, 320, 3)), "float64"),
        (np.full((240, 320, 3), GREEN[::-1], dtype=np.uint8), "no edge in any direction"),
    ],
)
def test_what_is_no_such_picture_is_refused(picture: Bytes, complaint: str) -> None:
    with pytest.raises(SourceError, match=complaint):
        recognize(picture, GEOMETRY, RENDERED)
