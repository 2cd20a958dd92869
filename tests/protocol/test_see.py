"""The exact datagram of a view."""

import math

import numpy as np
import pytest

from tests.protocol.samples import BOOT, CODES, simple_view
from vision_core.clock import Instant
from vision_core.models.mirror import PAPER_MIRROR, Mirror
from vision_core.protocol.answers import decode_message
from vision_core.protocol.messages import HIDDEN, Ball, See
from vision_core.protocol.options import MAX_DATAGRAM, PAPER_OPTIONS, Options
from vision_core.protocol.see import reference_ball, reference_px, reference_see
from vision_core.types.edges import EdgeKind
from vision_core.types.objects import Team
from vision_core.types.views import BallView, RobotView

BALL = BallView(distance_m=0.379, direction_deg=121.2, size_deg=6.45, partial=False)


def datagram(view: RobotView, options: Options = PAPER_OPTIONS, *, nul: bool = False) -> bytes:
    return reference_see(view, options, PAPER_MIRROR, CODES, BOOT, nul=nul)


def view_of(distances_m: list[float], kinds: list[int]) -> RobotView:
    """The first directions as given, walls at 1 m elsewhere."""
    distances, all_kinds = np.full(360, 1.0), np.full(360, EdgeKind.WALL, dtype=np.uint8)
    distances[: len(distances_m)], all_kinds[: len(kinds)] = distances_m, kinds
    return RobotView(Team.BLUE, 3, Instant(BOOT), 1, distances, all_kinds, None, False)


def test_golden_wall_at_220_mm() -> None:
    expected = b"(see 20306.148 ((edge) " + b"w2c" * 360 + b") ((ball) 61 121 6))"
    assert datagram(simple_view(ball=BALL)) == expected
    assert datagram(simple_view(ball=BALL), nul=True) == expected + b"\0"


def test_golden_nothing_within_range() -> None:
    nothing = simple_view(at=Instant(BOOT + 1), distance_m=math.inf, kind=EdgeKind.NOTHING)
    assert datagram(nothing) == b"(see 0.000 ((edge) " + b"-ff" * 360 + b") ((ball) -1 0 0))"


def test_golden_three_sorts_of_robots() -> None:
    view = view_of([0.11, 0.15, 0.5], [EdgeKind.ROBOT_BLUE, EdgeKind.ROBOT_BLUE + 2, EdgeKind.ROBOT_YELLOW + 5])
    for types, edges in (("same", b"r19r20r45"), ("team", b"x19x20y45"), ("number", b"x19B20e45")):
        expected = b"(see 0.000 ((edge) " + edges + b"w56" * 357 + b") ((ball) -1 0 0))"
        assert datagram(view, Options(types=types)) == expected


def test_the_worked_example_of_the_mirror() -> None:
    """The table of distances [mm] and pixels that comes with the default mirror."""
    mm = [110, 150, 220, 300, 380, 500, 700, 1000, 1500, 2000, 2750]
    px = ["19", "20", "2c", "35", "3d", "45", "4e", "56", "5d", "60", "63"]
    see = decode_message(datagram(view_of([d / 1000 for d in mm], [EdgeKind.WALL] * len(mm))))
    assert isinstance(see, See)
    assert see.edges[: 3 * len(px)].decode() == "".join(f"w{digits}" for digits in px)


def test_distances_are_cut_not_rounded() -> None:
    beyond = PAPER_MIRROR.mm_from_px(61.0) / 1000.0
    view = view_of([beyond * (1 - 1e-9), beyond * (1 + 1e-9)], [1, 1])
    assert reference_px(view, PAPER_MIRROR)[:2].tolist() == [60, 61]


def test_far_edges_are_fe_at_most() -> None:
    widest = Mirror(2.541967, 0.01, 100.0)
    assert 253.99 < widest.horizon_px <= 254.0
    px = reference_px(view_of([1e9, 1e300, math.inf, 1.0], [1, 1, 1, EdgeKind.NOTHING]), widest)
    assert px[:4].tolist() == [253, 253, 255, 255]


def test_time_is_cut_to_its_decimals() -> None:
    view = simple_view(at=Instant(BOOT + 1_999_999_999))
    assert datagram(view).startswith(b"(see 1.999 ((edge) ")
    assert datagram(view, Options(time="us")).startswith(b"(see 1.999999 ((edge) ")


@pytest.mark.parametrize(
    ("direction_deg", "expected"), [(0.4, 0), (0.5, 1), (359.4, 359), (359.5, 0), (359.6, 0), (121.5, 122)]
)
def test_directions_round_half_up(direction_deg: float, expected: int) -> None:
    ball = reference_ball(BallView(0.5, direction_deg, 4.9, False), PAPER_OPTIONS, PAPER_MIRROR)
    assert ball.direction_deg == expected


@pytest.mark.parametrize(
    ("size_deg", "full", "half"), [(0.2, 1, 1), (1.49, 1, 1), (2.5, 3, 1), (6.4, 6, 3), (180.0, 180, 90)]
)
def test_sizes(size_deg: float, full: int, half: int) -> None:
    ball = BallView(0.5, 10.0, size_deg, False)
    assert reference_ball(ball, PAPER_OPTIONS, PAPER_MIRROR).size_deg == full
    assert reference_ball(ball, Options(size="half"), PAPER_MIRROR).size_deg == half


def test_the_other_sense_mirrors_everything() -> None:
    view = view_of([0.11, 0.15, 0.22, 0.3], [1, 1, 1, 1])
    turned = reference_see(
        RobotView(Team.BLUE, 3, view.at, 1, view.distances_m, view.kinds, BALL, False),
        Options(sense="cw"),
        PAPER_MIRROR,
        CODES,
        BOOT,
    )
    see = decode_message(turned)
    assert isinstance(see, See)
    assert see.edges == b"w19" + b"w56" * 356 + b"w35w2cw20"
    assert see.ball.direction_deg == 239


def test_a_narrow_view_hides_the_ball_outside() -> None:
    def seen(direction_deg: float, center_deg: float = 0.0) -> Ball:
        options = Options(fov_deg=90.0, center_deg=center_deg)
        return reference_ball(BallView(0.5, direction_deg, 4.0, False), options, PAPER_MIRROR)

    assert seen(0.0) == Ball(69, 0, 4)
    assert seen(46.9) == Ball(69, 47, 4)  # its edge is in view
    assert seen(47.1) == HIDDEN
    assert seen(313.5) == Ball(69, 314, 4)
    assert seen(180.0) == HIDDEN
    assert seen(180.0, center_deg=-180.0) != HIDDEN


def test_the_clients_mirror_goes_before_the_fields() -> None:
    own = Mirror(1.933098, 0.00296946, 360000.0)
    see = decode_message(datagram(simple_view(distance_m=0.5, ball=BALL), Options(mirror=own)))
    assert isinstance(see, See)
    assert see.edges[:3] == b"w%02x" % int(own.px_from_mm(500.0))
    assert see.ball.px == int(own.px_from_mm(379.0))


def test_fine_directions_come_from_fine_views() -> None:
    options = Options(fov_deg=112.0, center_deg=0.0, resolution_deg=0.25, time="us")
    message = datagram(simple_view(rays=1440), options, nul=True)
    see = decode_message(message)
    assert isinstance(see, See)
    assert see.edges == b"w2c" * 448
    assert len(message) <= MAX_DATAGRAM
    with pytest.raises(ValueError, match="360 rays"):
        datagram(simple_view(), options)


def test_every_pixel_value_has_its_digits() -> None:
    distances = [PAPER_MIRROR.mm_from_px(px + 0.5) / 1000.0 for px in range(108)]
    see = decode_message(datagram(view_of(distances, [1] * len(distances))))
    assert isinstance(see, See)
    assert see.edges[: 3 * 108] == b"".join(b"w%02x" % px for px in range(108))
