"""Duration of encoding one frame's views: from the world to the datagrams of 10 and of 22 clients.

Measured [us]: median duration of one call of the compiled encoder over random worlds, with all robots on the field.
Two baselines encode the same worlds in the same process. The first is a C program (``baselines/views.c``) that takes
turns with the encoder; its datagrams must be the same bytes, and the goal is a ratio of at most 1.3. The second is the
protocol's reference implementation in Python, which encodes one view at a time.
"""

import ctypes
import time
from collections.abc import Callable
from typing import Any

import numpy as np
from msgspec.structs import replace

from bench.baselines.build import load_library
from bench.runner import Row
from bench.whole_loop import Client
from vision_core.clock import NS_PER_S, US_PER_S, Instant
from vision_core.geometry import Bytes
from vision_core.models.from_settings import mirror_of
from vision_core.net.delivery import Batch
from vision_core.pipeline.see_kernels import SLOT
from vision_core.pipeline.view_encoder import ViewEncoder
from vision_core.protocol.see import reference_see
from vision_core.settings.schema import Settings
from vision_core.types.objects import Team
from vision_core.types.tables import WorldTable
from vision_core.types.tracks import BallTrack, RobotTrack, World
from vision_core.venues.loader import load_settings
from vision_core.views.renderer import StaticScene

TEAM_SIZES = (5, 11)
WORLDS = 40
ROUNDS = 1500
REFERENCE_ROUNDS = 20
GOAL_RATIO = 1.3
BOOT = Instant(0)

OUTLINE = np.dtype(
    [(name, np.float64) for name in ("x", "y", "heading", "cosine", "sine")]
    + [("kind", np.int32), ("viewer", np.int32)]
)
SCENE = np.dtype(
    [(name, np.float64) for name in ("a", "b", "c", "d", "radius", "ball_radius", "limit_x", "limit_y")]
    + [("segments", np.int64), ("solid", np.int64)]
)


def run() -> list[Row]:
    """Rows for both sizes of a team."""
    return [row for size in TEAM_SIZES for row in _measure(size)]


def _measure(size: int) -> list[Row]:
    settings = _settings(size)
    tables = [WorldTable.of(_world(np.random.default_rng(seed), settings, size)) for seed in range(WORLDS)]
    clients = tuple(Client(team, number) for team in Team for number in range(1, size + 1))
    encoder = ViewEncoder(settings, BOOT)
    methods: list[Callable[[int], object]] = [lambda number: encoder.write(tables[number % WORLDS], clients)]
    c_baseline, compiler = _c_baseline(encoder, tables, clients, settings)
    if c_baseline is not None:
        methods.append(c_baseline)
    encoder_us, *c_us = _in_turns(methods, ROUNDS)
    (reference_us,) = _in_turns([_by_reference(encoder, settings, tables, clients)], REFERENCE_ROUNDS)
    name = f"edges and text of {2 * size} robots"
    against = {"name": f"{name}, baseline in C", "baseline": c_us[0], "ratio": encoder_us / c_us[0]} if c_us else {}
    return [
        {
            "name": f"{name} ({compiler})",
            "value": encoder_us,
            "unit": "us",
            "goal": f"<= {GOAL_RATIO}x",
            "met": encoder_us <= GOAL_RATIO * c_us[0] if c_us else None,
            **against,
        },
        {
            "name": f"{name}, baseline the reference implementation in Python",
            "value": encoder_us,
            "unit": "us",
            "baseline": reference_us,
            "ratio": encoder_us / reference_us,
        },
    ]


def _in_turns(methods: list[Callable[[int], object]], rounds: int) -> list[float]:
    """Median duration of each method [us]; the methods take turns."""
    seconds: list[list[float]] = [[] for _ in methods]
    for number in range(rounds):
        for method, durations in zip(methods, seconds, strict=True):
            began = time.perf_counter()
            method(number)
            durations.append(time.perf_counter() - began)
    return [float(np.median(durations[len(durations) // 10 :])) * US_PER_S for durations in seconds]


def _settings(size: int) -> Settings:
    settings = load_settings()
    return replace(settings, match=replace(settings.match, numbers=size))


def _world(rng: np.random.Generator, settings: Settings, size: int) -> World:
    half = settings.field.length_m / 2.0, settings.field.width_m / 2.0
    robots = []
    for team in Team:
        for marker in settings.match.ids_of(team)[:size]:
            x, y, heading = rng.uniform(-half[0], half[0]), rng.uniform(-half[1], half[1]), rng.uniform(-3.1, 3.1)
            robots.append(RobotTrack(team, marker, x, y, heading, 0.0, 0.0, 0.0, 1e-4, 1e-3, 1.0, BOOT))
    ball = BallTrack(rng.uniform(-half[0], half[0]), rng.uniform(-half[1], half[1]), 0.0, 0.0, 1e-4, False, BOOT)
    return World(1, Instant(20_306 * NS_PER_S + int(rng.integers(NS_PER_S))), tuple(robots), ball, ())


def _by_reference(
    encoder: ViewEncoder, settings: Settings, tables: list[WorldTable], clients: tuple[Client, ...]
) -> Callable[[int], object]:
    """The protocol's reference implementation as a function of the round's number: one view and datagram at a time."""

    mirror = mirror_of(settings.mirror, Team.BLUE)

    def encode(number: int) -> list[bytes]:
        world, sent = tables[number % WORLDS], []
        encoder.renderer.render(world)
        for client in clients:
            view = encoder.renderer.view(world, client.team, client.number)
            assert view is not None
            sent.append(reference_see(view, client.options, mirror, encoder.codes, BOOT))
        return sent

    return encode


def _c_baseline(
    encoder: ViewEncoder, tables: list[WorldTable], clients: tuple[Client, ...], settings: Settings
) -> tuple[Callable[[int], object] | None, str]:
    """The baseline in C as a function of the round's number, and the compiler's command; or None and the reason.

    Its datagrams are checked to be the same bytes.
    """
    library, compiler = load_library("views", "-fno-math-errno")
    if library is None:
        return None, compiler
    scene = encoder.renderer.scene
    count = len(clients)
    page = np.zeros((count, 2, 360), dtype=np.uint8)
    slots = np.zeros(count * SLOT, dtype=np.uint8)
    starts, lengths = np.zeros(count, dtype=np.int64), np.zeros(count, dtype=np.int64)
    # arrays of the C structures: the same for all worlds, then outlines and ball of each world
    arguments = [
        _scene_row(scene, settings), scene.segments_m, scene.segment_kinds, scene.ray_x, scene.ray_y,
        encoder.text.hex_words, np.ascontiguousarray(encoder.text.edge_codes[0]), page, slots, starts, lengths,
    ]  # fmt: skip
    calls = []
    for table in tables:
        outlines, ball = _outlines_of(table, scene), np.array([table.balls[0]["x_m"], table.balls[0]["y_m"]])
        arguments += [outlines, ball]
        calls.append(
            (
                _address(outlines),
                ctypes.c_int64(count),
                _address(ball),
                ctypes.c_int64(int(table.whole[0]["at"])),
                *map(_address, arguments[:11]),
            )
        )
    # every datagram must be the same bytes
    for table, call in zip(tables, calls, strict=True):
        library.encode_views(*call)
        batch = encoder.write(table, clients)
        for row in range(count):
            assert bytes(batch.datagram(row)) == bytes(Batch(slots, starts, lengths).datagram(row))
    # the function keeps the arrays alive that the calls point to
    return lambda number: (library.encode_views(*calls[number % len(calls)]), arguments)[0], compiler


def _address(array: "np.ndarray[Any, Any]") -> ctypes.c_void_p:
    return ctypes.c_void_p(array.ctypes.data)


def _outlines_of(table: WorldTable, scene: StaticScene) -> "np.ndarray[Any, Any]":
    robots = table.robots[: table.counts[0]]
    outlines = np.zeros(len(robots), dtype=OUTLINE)
    outlines["x"], outlines["y"], outlines["heading"] = robots["x_m"], robots["y_m"], robots["heading_rad"]
    kinds: Bytes = scene.kind_of_id[robots["team"], robots["id"] + 1]
    outlines["kind"], outlines["viewer"] = kinds, scene.viewer_of_id[robots["team"], robots["id"]]
    return outlines


def _scene_row(scene: StaticScene, settings: Settings) -> "np.ndarray[Any, Any]":
    mirror = mirror_of(settings.mirror, Team.BLUE)
    row = np.zeros(1, dtype=SCENE)
    row[0] = (
        mirror.a, mirror.b, mirror.c, mirror.a**2 - mirror.b**2 * mirror.c, settings.robots.radius_m,
        settings.ball.radius_m, *scene.limit_m, len(scene.segments_m), scene.solid,
    )  # fmt: skip
    return row
