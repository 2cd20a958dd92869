"""A world in, datagrams out: the compiled writer against the reference, ``protocol.see``, for every option."""

import dataclasses
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import settings as hypothesis_settings
from hypothesis import strategies as st
from msgspec.structs import replace

from bench.whole_loop import Client
from tests.views.scenes import AT, SETTINGS, ball, fields, obstacle, random_world, robot, with_squares, world
from vision_core.clock import Instant
from vision_core.models.from_settings import mirror_of
from vision_core.models.mirror import PAPER_MIRROR, Mirror
from vision_core.net.delivery import Batch
from vision_core.pipeline import view_encoder as module
from vision_core.pipeline.view_encoder import ViewEncoder
from vision_core.protocol.answers import decode_message
from vision_core.protocol.edge_codes import edge_codes
from vision_core.protocol.messages import HIDDEN, See
from vision_core.protocol.options import EXTRAS, MAX_DATAGRAM, PAPER_OPTIONS, Options, options_from_forms
from vision_core.protocol.see import reference_ball, reference_px, reference_see
from vision_core.settings.schema import MirrorConstants
from vision_core.types.edges import EdgeKind
from vision_core.types.objects import Team
from vision_core.types.tables import WorldTable
from vision_core.types.tracks import World
from vision_core.types.views import RobotView

CODES = edge_codes(SETTINGS.protocol.letters)
MIRROR = mirror_of(SETTINGS.mirror, Team.BLUE)
BOOT = Instant(500_000_000)
ENCODER = ViewEncoder(with_squares(), BOOT)


def blue_1(options: Options = PAPER_OPTIONS, *, nul: bool = False) -> Client:
    return Client(Team.BLUE, 1, options, nul)


def reference(table: WorldTable, client: Client, encoder: ViewEncoder = ENCODER) -> bytes | None:
    """What the reference makes of a view of the world that was rendered last."""
    view = encoder.renderer.view(table, client.team, client.number)
    if view is None:
        return None
    extras = {name: words for name, words in extras_of(table, view, client).items() if name in client.options.extras}
    return reference_see(view, client.options, MIRROR, CODES, BOOT, nul=client.nul, extras=extras)


def extras_of(table: WorldTable, view: RobotView, client: Client) -> dict[str, tuple[str, ...]]:
    """Every extra of a view that is written when its image was grabbed, from the world's track of its robot."""
    robots = table.record().robots
    marker = (SETTINGS.match.blue_ids if view.team is Team.BLUE else SETTINGS.match.yellow_ids)[view.number - 1]
    own = next(one for one in robots if (one.team, one.id) == (view.team, marker))
    is_told = reference_ball(view.ball, client.options, client.options.mirror or MIRROR) != HIDDEN
    flags = {
        "overlap": view.overlap,
        "partial": is_told and view.ball is not None and view.ball.partial,
        "predicted": own.seen < view.at,
    }
    us = (view.at - BOOT) // 1000
    return {
        "seq": (str(view.frame_number),),
        "age": ("0",),
        "sent": (f"{us // 10**6}.{us % 10**6:06d}",),
        "conf": (str(round(100 * own.confidence)),),
        "flags": tuple(name for name, holds in flags.items() if holds),
    }


def see(batch: Batch, line: int = 0) -> See:
    message = decode_message(bytes(batch.datagram(line)))
    assert isinstance(message, See)
    return message


@st.composite
def options(draw: st.DrawFn) -> Options:
    """Anything that an init may ask for."""
    resolution = draw(st.sampled_from([0.25, 0.5, 0.75, 1.0, 1.25, 2.0, 3.0, 7.5, 45.0, 360.0]))
    most = min(360.0, resolution * 448)
    width = draw(st.integers(1, int(most * 2))) / 2.0
    asked = Options(
        types=draw(st.sampled_from(["same", "team", "number"])),
        mirror=draw(st.sampled_from([None, PAPER_MIRROR, Mirror(2.0, 0.007, 40000.0), MIRROR])),
        fov_deg=max(width, resolution),
        center_deg=draw(st.integers(-720, 720)) / 2.0,
        resolution_deg=resolution,
        time=draw(st.sampled_from(["ms", "us"])),
        size=draw(st.sampled_from(["full", "half"])),
        sense=draw(st.sampled_from(["ccw", "cw"])),
    )
    if asked.directions < 400:
        chosen = draw(st.sets(st.sampled_from(list(EXTRAS))))
        asked = dataclasses.replace(asked, version=2, extras=tuple(name for name in EXTRAS if name in chosen))
    return asked if (asked.first_deg * 4.0).is_integer() else dataclasses.replace(asked, center_deg=0.0, fov_deg=90.0)


@given(
    asked=st.lists(options(), min_size=1, max_size=4),
    seed=st.integers(0, 2**32 - 1),
    at=st.integers(BOOT, BOOT + 10**18),
    nul=st.booleans(),
)
@hypothesis_settings(max_examples=60, deadline=None)
def test_every_datagram_is_byte_for_byte_what_the_protocol_says(
    asked: list[Options], seed: int, at: int, nul: bool
) -> None:
    here = dataclasses.replace(random_world(np.random.default_rng(seed), fields()["walls"]), at=Instant(at))
    table = WorldTable.of(here)
    clients = [
        Client(*who, option, nul)
        for who, option in zip(
            [(Team.BLUE, 1), (Team.BLUE, 2), (Team.YELLOW, 3), (Team.YELLOW, 5)], asked, strict=False
        )
    ]
    batch = ENCODER.write(table, clients)
    for line, client in enumerate(clients):
        expected = reference(table, client)
        sent = bytes(batch.datagram(line))
        assert sent == expected or (expected is None and (sent == b"" or client.options.version == 2))


def test_a_client_of_version_2_is_told_that_its_robot_is_not_seen() -> None:
    table = WorldTable.of(dataclasses.replace(world(ball=ball(0.1, 0.2)), at=Instant(BOOT + 1_500_000_000)))
    clients = [
        blue_1(Options(version=2, fov_deg=4.0, center_deg=0.0, extras=("seq",)), nul=True),
        blue_1(Options(fov_deg=4.0, center_deg=0.0)),
    ]
    batch = ENCODER.write(table, clients)
    told = (
        b"(see 1.500 ((edge) -ff-ff-ff-ff) ((ball) -1 0 0) ((seq) %d) ((flags) nopose))\0" % table.record().frame_number
    )
    assert [bytes(batch.datagram(line)) for line in range(2)] == [told, b""]


def test_the_age_of_a_view_and_when_it_was_written() -> None:
    here = dataclasses.replace(world(robot(Team.BLUE, 1, 0.0, 0.0)), at=Instant(BOOT + 10**9))
    asked = Options(version=2, fov_deg=1.0, center_deg=0.0, extras=("age", "sent"))
    batch = ENCODER.write(WorldTable.of(here), [blue_1(asked)], now=Instant(BOOT + 10**9 + 12_345_678))
    assert bytes(batch.datagram(0)).endswith(b" ((age) 12345) ((sent) 1.012345))")


def test_the_longest_datagram_with_all_extras_fits() -> None:
    late = Instant(BOOT + 9_199_999_999_999_999_000)
    here = world(robot(Team.BLUE, 1, 0.0, 0.0), ball=ball(0.5, 0.4))
    table = WorldTable.of(dataclasses.replace(here, at=late))
    forms = [("version", "2"), ("extra", *EXTRAS), ("time", "us"), ("resolution", "0.25")]
    widths = (("fov", str(directions / 4)) for directions in range(448, 0, -1))
    asked = next(found[0] for width in widths if isinstance(found := options_from_forms([*forms, width]), tuple))
    batch = ENCODER.write(table, [blue_1(asked, nul=True)], now=Instant(late + 10**15))
    assert 1200 < len(batch.datagram(0)) <= MAX_DATAGRAM


@pytest.mark.parametrize("name", list(fields()))
def test_all_robots_of_a_full_field(name: str) -> None:
    settings = replace(SETTINGS, field=fields()[name], match=replace(SETTINGS.match, numbers=16))
    encoder, rng = ViewEncoder(settings, BOOT), np.random.default_rng(3)
    robots = [
        robot(team, marker, rng.uniform(-1.0, 1.0), rng.uniform(-1.0, 1.0), rng.uniform(-3.0, 3.0))
        for team, ids in ((Team.BLUE, settings.match.blue_ids), (Team.YELLOW, settings.match.yellow_ids))
        for marker in ids
    ]
    table = WorldTable.of(dataclasses.replace(world(*robots, ball=ball(0.1, 0.2)), at=Instant(BOOT + 1)))
    clients = [Client(team, number) for team in Team for number in range(1, 17)]
    batch = encoder.write(table, clients)
    for line, client in enumerate(clients):
        assert bytes(batch.datagram(line)) == reference(table, client, encoder)
    snapshot = encoder.views.record()
    assert [(view.team, view.number) for view in snapshot.views] == [(c.team, c.number) for c in clients]


def test_the_longest_and_the_shortest_datagram() -> None:
    late = Instant(BOOT + 9_199_999_999_999_999_000)  # int64 ends a little later
    here = world(robot(Team.BLUE, 1, 0.0, 0.0), ball=ball(0.5, 0.4))
    table = WorldTable.of(dataclasses.replace(here, at=late))
    found = options_from_forms([("fov", "112"), ("resolution", "0.25"), ("time", "us")])
    assert isinstance(found, tuple)
    clients = [
        blue_1(found[0], nul=True),
        Client(Team.BLUE, 2),
        blue_1(Options(fov_deg=360.0, resolution_deg=360.0)),
    ]
    batch = ENCODER.write(table, clients)
    lengths = [len(batch.datagram(line)) for line in range(3)]
    assert lengths[0] == 1344 + len("(see 9199999999.999999 ((edge) ) ((ball) 74 39 4))\0")
    assert lengths[1] == 0
    assert bytes(batch.datagram(2)).startswith(b"(see 9199999999.999 ((edge) v")
    for line in (0, 2):
        assert bytes(batch.datagram(line)) == reference(table, clients[line])


def test_what_was_grabbed_before_the_start_has_time_0() -> None:
    before = dataclasses.replace(world(robot(Team.BLUE, 1, 0.0, 0.0)), at=Instant(BOOT - 1))
    assert see(ENCODER.write(WorldTable.of(before), [blue_1()])).time_us == 0


def test_only_who_is_due_gets_a_datagram_and_a_new_sequence_is_looked_at_anew() -> None:
    table = WorldTable.of(world(robot(Team.BLUE, 1, 0.0, 0.0), robot(Team.BLUE, 2, 0.5, 0.0)))
    clients = [blue_1(), Client(Team.BLUE, 2)]
    batch = ENCODER.write(table, clients, np.array([0, 1], dtype=np.uint8))
    assert [len(batch.datagram(line)) > 0 for line in (0, 1)] == [False, True]
    batch = ENCODER.write(table, [clients[1]])
    assert bytes(batch.datagram(0)) == reference(table, clients[1])


def test_what_blue_1_sees() -> None:
    """Yellow 2 a meter ahead, the ball half a meter to the left, an obstacle to the right."""
    encoder = ViewEncoder(SETTINGS, BOOT)
    yellow = SETTINGS.match.yellow_ids[1]
    here = dataclasses.replace(
        world(robot(Team.BLUE, 1, 0.0, 0.0), robot(Team.YELLOW, yellow, 1.0, 0.0), ball=ball(0.0, 0.5)),
        obstacles=(obstacle(0.0, -0.4, 0.1),),
        at=Instant(BOOT + 20_306_148_000_000),
    )
    message = see(encoder.write(WorldTable.of(here), [blue_1()]))
    assert message.time_us == 20_306_148_000
    assert len(message.edges) == 1080
    assert message.edges[:3] == f"r{int(MIRROR.px_from_mm(910.0)):02x}".encode()
    assert message.edges[270:273] == f"w{int(MIRROR.px_from_mm(500.0 * SETTINGS.field.width_m)):02x}".encode()
    assert message.edges[810:813] == f"q{int(MIRROR.px_from_mm(300.0)):02x}".encode()
    size_deg = round(math.degrees(2.0 * math.asin(SETTINGS.ball.radius_m / 0.5)))
    found = message.ball
    assert (found.px, found.direction_deg, found.size_deg) == (int(MIRROR.px_from_mm(500.0)), 90, size_deg)


@pytest.mark.parametrize("asked", [PAPER_OPTIONS, Options(fov_deg=90.0, resolution_deg=0.25, mirror=PAPER_MIRROR)])
def test_the_page_gets_the_teams_pixels_whatever_clients_ask_for(asked: Options) -> None:
    table = WorldTable.of(random_world(np.random.default_rng(5), fields()["walls"]))
    ENCODER.write(table, [blue_1(asked)])
    snapshot = ENCODER.views.record()
    assert (snapshot.frame_number, snapshot.at) == (7, AT)
    page = {(view.team, view.number): view for view in snapshot.views}
    ENCODER.renderer.buffers.rays[:] = 360
    ENCODER.renderer.render(table)
    for team in Team:
        for number in range(1, 6):
            view = ENCODER.renderer.view(table, team, number)
            assert (view is None) == ((team, number) not in page)
            if view is None:
                continue
            shown = page[team, number]
            assert shown.px == reference_px(view, MIRROR).tobytes()
            assert shown.kinds == view.kinds.tobytes()
            expected = reference_ball(view.ball, PAPER_OPTIONS, MIRROR)
            assert (shown.ball_px, shown.ball_direction_deg) == (expected.px, expected.direction_deg)
            assert shown.partial == (view.ball is not None and view.ball.partial)
            assert shown.overlap == view.overlap


def test_the_page_gets_of_each_team_what_that_team_gets() -> None:
    """A team with a mirror of its own: pixels and ball of the page's view are those of the team's datagram."""
    other = MirrorConstants(4.2, 0.0131, 91_000.0)
    encoder = ViewEncoder(replace(SETTINGS, mirror=replace(SETTINGS.mirror, yellow=other)), BOOT)
    clients = tuple(Client(team, 1, PAPER_OPTIONS) for team in Team)
    blue, yellow = SETTINGS.match.blue_ids[0], SETTINGS.match.yellow_ids[0]
    both = robot(Team.BLUE, blue, 0.5, 0.2, 0.3), robot(Team.YELLOW, yellow, -0.4, -0.3, 2.0)
    batch = encoder.write(WorldTable.of(world(*both, ball=ball(0.1, 0.1))), clients)
    views = encoder.views.record().views
    assert [view.team for view in views] == list(Team)
    for line, view in enumerate(views):
        sent = see(batch, line)
        assert view.px.hex() == "".join(sent.edges.decode()[at + 1 : at + 3] for at in range(0, 3 * 360, 3))
        assert (view.ball_px, view.ball_direction_deg) == (sent.ball.px, sent.ball.direction_deg)


def test_a_robot_with_a_mirror_of_its_own_sees_through_it_and_its_team_does_not() -> None:
    own = Mirror(4.2, 0.0131, 91_000.0)
    robots = {"blue 2": MirrorConstants(own.a, own.b, own.c)}
    encoder = ViewEncoder(replace(SETTINGS, mirror=replace(SETTINGS.mirror, robots=robots)), BOOT)
    clients = tuple(Client(Team.BLUE, number) for number in (1, 2))
    table = WorldTable.of(world(*(robot(Team.BLUE, SETTINGS.match.blue_ids[n], 0.5 * n, 0.2) for n in (0, 1))))
    batch = encoder.write(table, clients)
    for line, (client, mirror) in enumerate(zip(clients, (MIRROR, own), strict=True)):
        view = encoder.renderer.view(table, Team.BLUE, client.number)
        assert view is not None
        assert bytes(batch.datagram(line)) == reference_see(view, PAPER_OPTIONS, mirror, CODES, BOOT)
        assert encoder.views.record().views[line].px == reference_px(view, mirror).tobytes()


def test_a_robot_at_no_finite_place_has_no_view() -> None:
    here: World = world(robot(Team.BLUE, 1, math.nan, 0.0), robot(Team.BLUE, 2, 0.3, 0.0))
    batch = ENCODER.write(WorldTable.of(here), [blue_1(), Client(Team.BLUE, 2)])
    assert len(batch.datagram(0)) == 0
    assert see(batch, 1).edges.count(b"w") > 100


def test_directions_off_the_grid_raise() -> None:
    with pytest.raises(ValueError, match=r"every 0.3 deg"):
        ENCODER.request(Team.BLUE, 1, Options(resolution_deg=0.3), nul=False)


def test_marks_must_be_one_for_each_client() -> None:
    with pytest.raises(ValueError, match="2 marks for 1 clients"):
        ENCODER.write(WorldTable.of(world()), [blue_1()], np.ones(2, dtype=np.uint8))


def test_one_signature_is_compiled() -> None:
    """Another one would be compiled while a frame waits."""
    for due in (None, np.ones(1, dtype=np.uint8)):
        ENCODER.write(WorldTable.of(world(robot(Team.BLUE, 1, 0.0, 0.0))), [blue_1()], due)
    ENCODER.write(WorldTable(bytes(WorldTable().bytes)), ())
    assert len(module.encode_views.signatures) == 1  # type: ignore[attr-defined]


def test_edges_of_every_kind_have_their_letters() -> None:
    table = WorldTable.of(world(robot(Team.BLUE, 1, 0.0, 0.0), robot(Team.YELLOW, None, 0.4, 0.0)))
    for types, letter in (("same", b"r"), ("team", b"y"), ("number", b"y")):
        message = see(ENCODER.write(table, [blue_1(Options(types=types))]))
        assert message.edges[:1] == letter
    assert EdgeKind.ROBOT_YELLOW in ENCODER.renderer.buffers.kinds[:360]
