"""The sixth and seventh stage combined: a world in, every client's datagram and the page's views out.

One compiled call per frame, into preallocated memory; no sockets, processes or clocks, so that tests and
benchmarks use the same code as the service.
"""

from collections.abc import Sequence
from typing import NamedTuple, Protocol

import numpy as np

from vision_core.clock import NS_PER_US, Instant
from vision_core.geometry import Bytes
from vision_core.models.from_settings import mirrors_of
from vision_core.native.kernels import Boxed, box, kernel
from vision_core.net.delivery import Batch
from vision_core.pipeline.see_kernels import (
    EXTRA_BITS,
    REQUEST,
    SLOT,
    Moment,
    TextBuffers,
    Track,
    ball_numbers,
    view_px,
    write_see,
)
from vision_core.protocol.edge_codes import TYPES, edge_codes
from vision_core.protocol.messages import NOTHING_PX
from vision_core.protocol.options import PAPER_OPTIONS, TICKS_PER_DEG, Options
from vision_core.settings.schema import Settings
from vision_core.types.edges import EdgeKind
from vision_core.types.objects import Team
from vision_core.types.tables import DIRECTIONS, MAX_NUMBERS, Table, ViewsTable, WorldTable
from vision_core.views.outlines import Integers
from vision_core.views.renderer import (
    MAX_RAYS,
    VIEWERS,
    StaticScene,
    ViewBuffers,
    ViewRenderer,
    render_views,
    viewer_index,
)


class Client(Protocol):
    """The part of a session that decides what is sent to it."""

    @property
    def team(self) -> Team: ...
    @property
    def number(self) -> int: ...
    @property
    def options(self) -> Options: ...
    @property
    def nul(self) -> bool: ...


class EncoderContext(NamedTuple):
    """Arguments of ``encode_views`` that stay the same while no client comes or goes."""

    boot: int
    """Instant at which Time is 0 [ns]."""
    scene: StaticScene
    views: ViewBuffers
    page_requests: Table
    """The REQUEST of the page's view of each robot, shape (VIEWERS,)."""
    page_views: Table
    """Output: VIEWS, shape (1,)."""
    requests: Table
    """The REQUEST of each client, shape (n,)."""
    text: TextBuffers
    nothing_kinds: Bytes
    """What a robot sees that the camera does not see: nothing in every direction, shape (MAX_RAYS,)."""
    nothing_px: Bytes
    starts: Integers
    """Output: place of each client's datagram in text.text [bytes], shape (n,)."""
    lengths: Integers
    """Output: length of each client's datagram [bytes]; 0: none this frame; shape (n,)."""


@kernel
def encode_views(world: Table, due: Bytes, now: int, boxed: Boxed) -> None:
    """Render the views of a world, and encode them: as snapshots for the page, as datagrams for the clients due.

    world: WORLD, shape (1,); due: 1 for the clients that get a datagram, shape (n,); now: when they are written [ns];
    boxed: EncoderContext.
    """
    context: EncoderContext = boxed.value
    views, requests, text = context.views, context.requests, context.text
    starts, lengths = context.starts, context.lengths
    # Each view has the finest grid that any of its clients needs.
    views.rays[:] = DIRECTIONS
    for k in range(len(requests)):
        if due[k]:
            index = requests[k].viewer
            views.rays[index] = max(views.rays[index], requests[k].rays)
    render_views(world, context.scene, views)
    _write_page_views(world, views, context.page_requests, text.page_px, context.page_views)
    at = world[0].at
    moment = Moment(
        world[0].frame_number, max(at - context.boot, 0) // NS_PER_US, max(now - context.boot, 0) // NS_PER_US
    )
    for k in range(len(requests)):
        request = requests[k]
        viewer = views.viewers[request.viewer]
        rays = views.rays[request.viewer]
        if not due[k] or (viewer.robot < 0 and not request.blind):
            starts[k] = lengths[k] = 0
            continue
        if viewer.robot < 0:
            viewer.ball_visible = 0.0
            kinds, px, track = context.nothing_kinds[:rays], context.nothing_px[:rays], Track(0, False)
            starts[k], lengths[k] = write_see(moment, viewer, track, request, rays, kinds, px, k, text)
            continue
        robot = world[0].robots[viewer.robot]
        track = Track(round(100.0 * robot.confidence), robot.seen < at)
        # Pixels through the robot's mirror are computed already, for the page.
        kinds, px = views.kinds[viewer.first_ray : viewer.first_ray + rays], text.px[:rays]
        if rays == DIRECTIONS and not request.own_mirror:
            px = text.page_px[request.viewer]
        else:
            view_px(views.distances_m[viewer.first_ray :], request.a, request.b, request.c, request.d, px)
        starts[k], lengths[k] = write_see(moment, viewer, track, request, rays, kinds, px, k, text)


@kernel
def _write_page_views(world: Table, views: ViewBuffers, page: Table, page_px: Bytes, page_views: Table) -> None:
    """Write the views for the page, in the pixels of each robot's mirror, ordered by team and number."""
    count = 0
    for index in range(VIEWERS):
        viewer = views.viewers[index]
        if viewer.robot < 0:
            continue
        request, view = page[index], page_views[0].views[count]
        count += 1
        view.team, view.number = index // MAX_NUMBERS, index % MAX_NUMBERS + 1
        view.overlap, view.partial = viewer.overlap, 0.0 < viewer.ball_visible < 1.0
        view.ball_px, view.ball_direction_deg, view.ball_size_deg = ball_numbers(viewer, request)
        finer = views.rays[index] // DIRECTIONS
        distances, kinds, px = views.distances_m[viewer.first_ray :], views.kinds[viewer.first_ray :], page_px[index]
        if finer == 1:  # compiled for contiguous memory, which is three times as fast
            view_px(distances, request.a, request.b, request.c, request.d, px)
            _copy(kinds, view.kinds)
        else:
            view_px(distances[::finer], request.a, request.b, request.c, request.d, px)
            _copy(kinds[::finer], view.kinds)
        _copy(px, view.px)
    page_views[0].frame_number, page_views[0].at, page_views[0].count = world[0].frame_number, world[0].at, count


@kernel
def _copy(source: Bytes, target: Bytes) -> None:
    """Fill an array from the start of another. A slice would compile numba's message for slices of other lengths."""
    for index in range(len(target)):
        target[index] = source[index]


class ViewEncoder:
    """Renders and encodes the views of a world. Holds memory, but no state from one frame to the next.

    Raises SettingsError for edge letters that are not allowed.
    """

    def __init__(self, settings: Settings, boot: Instant) -> None:
        """boot: instant at which Time is 0."""
        self.renderer = ViewRenderer(settings)
        self._boot = boot
        self._mirrors = mirrors_of(settings.mirror)
        """Of each robot, for the page's views and for clients that ask for no other."""
        self.codes = edge_codes(settings.protocol.letters)
        self._letters = np.array([self.codes[types] for types in TYPES])
        self._page: Table = np.zeros(VIEWERS, dtype=REQUEST)
        for team, number in self._mirrors:
            self._page[viewer_index(team, number)] = self.request(team, number, PAPER_OPTIONS, nul=False)
        self.views = ViewsTable()
        """The page's views of the last world."""
        self._page_px = np.zeros((VIEWERS, DIRECTIONS), dtype=np.uint8)
        self._nothing_kinds = np.full(MAX_RAYS, EdgeKind.NOTHING, dtype=np.uint8)
        self._nothing_px = np.full(MAX_RAYS, NOTHING_PX, dtype=np.uint8)
        self._prepare(())

    def write(
        self, world: WorldTable, clients: Sequence[Client], due: Bytes | None = None, now: Instant | None = None
    ) -> Batch:
        """The datagrams of a world, one for each client that is due (None: all) and whose robot is in it.

        A client of version 2 is told as well when its robot is not in it. now: None: when the image was grabbed.

        The next call overwrites them. The clients' options are read only when `clients` is another object than in the
        last call. due: 1 or 0 for each client. Raises ValueError unless there is one for each client.
        """
        if clients is not self._clients:
            self._prepare(clients)
        due = self._all if due is None else due
        if len(due) != len(clients):
            raise ValueError(f"{len(due)} marks for {len(clients)} clients")
        encode_views(world.whole, due, int(world.whole[0]["at"]) if now is None else now, self._boxed)
        return self._batch

    def request(self, team: Team, number: int, options: Options, *, nul: bool) -> Table:
        """A client's row of REQUEST. Raises ValueError when its directions are on no grid of a view."""
        given = self._mirrors[team, number]
        mirror = options.mirror or given
        rays = options.rays_per_circle
        per_deg = rays // 360
        sign = 1 if options.sense == "ccw" else -1
        first, step = options.first_deg * per_deg, options.resolution_deg * per_deg
        if not (first.is_integer() and step.is_integer()):
            raise ValueError(
                f"directions every {options.resolution_deg:g} deg; accepted: every 1 / {TICKS_PER_DEG} deg"
            )
        row: Table = np.zeros(1, dtype=REQUEST)
        row[0] = (
            viewer_index(team, number), rays, sign * int(first) % rays, sign * int(step) % rays, options.directions,
            TYPES.index(options.types), options.sense == "cw", options.size == "half", options.time == "us", nul,
            mirror != given, sum(EXTRA_BITS[name] for name in options.extras), options.version > 1,
            options.fov_deg, options.center_deg, mirror.a, mirror.b, mirror.c, mirror.d,
        )  # fmt: skip
        return row[0]  # type: ignore[no-any-return]

    def _prepare(self, clients: Sequence[Client]) -> None:
        """Take memory for so many clients and read their options."""
        count = len(clients)
        self._clients = clients
        self._requests: Table = np.zeros(count, dtype=REQUEST)
        for row, client in enumerate(clients):
            self._requests[row] = self.request(client.team, client.number, client.options, nul=client.nul)
        words = np.zeros(max(count, 1) * SLOT // 4, dtype=np.uint32)
        hex_words = np.frombuffer("".join(f"\0{value:02x}\0" for value in range(256)).encode(), dtype=np.uint32).copy()
        text = words.view(np.uint8)
        self.text = TextBuffers(
            hex_words, self._letters, text, words, np.zeros(MAX_RAYS, dtype=np.uint8), self._page_px
        )
        self._all = np.ones(count, dtype=np.uint8)
        self._batch = Batch(text, np.zeros(count, dtype=np.int64), np.zeros(count, dtype=np.int64))
        self._boxed = box(
            EncoderContext(
                int(self._boot), self.renderer.scene, self.renderer.buffers, self._page, self.views.whole,
                self._requests, self.text, self._nothing_kinds, self._nothing_px, self._batch.starts,
                self._batch.lengths,
            )
        )  # fmt: skip
