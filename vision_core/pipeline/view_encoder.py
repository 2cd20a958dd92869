"""The sixth and seventh stage composed: a world in, every client's datagram and the page's views out.

One compiled call per frame, into memory that was taken once; no sockets, processes or clocks, so that tests and
benchmarks use the same code as the service.
"""

from collections.abc import Sequence
from typing import NamedTuple, Protocol

import msgspec
import numpy as np

from vision_core.clock import Instant
from vision_core.geometry import Bytes
from vision_core.models.from_settings import mirror_from
from vision_core.models.mirror import Mirror
from vision_core.native.kernels import Boxed, box, kernel
from vision_core.net.delivery import Batch
from vision_core.pipeline.see_kernels import REQUEST, SLOT, Ink, ball_words, mirror_px, write_see
from vision_core.protocol.edge_codes import LetterTable, letters_by_kind
from vision_core.protocol.messages import Init
from vision_core.protocol.options import PAPER_OPTIONS, TICKS_PER_DEG, Options
from vision_core.settings.schema import Settings
from vision_core.types.objects import Team
from vision_core.types.tables import DIRECTIONS, MAX_NUMBERS, Table, ViewsTable, WorldTable
from vision_core.views.outlines import Integers
from vision_core.views.renderer import MAX_RAYS, VIEWERS, Eyes, Place, Sight, look_all, viewer_of

TYPES = ("same", "team", "number")


class Client(Protocol):
    """What a session tells of its wishes."""

    @property
    def init(self) -> Init: ...
    @property
    def nul(self) -> bool: ...


class Desk(NamedTuple):
    """What stays the same from frame to frame while no client comes or goes, and where to write."""

    boot: int
    place: Place
    sight: Sight
    page: Table
    """The REQUEST of the page, shape (1,)."""
    views: Table
    """VIEWS, shape (1,)."""
    requests: Table
    """Of all clients, shape (n,)."""
    ink: Ink
    starts: Integers
    """Filled in, of each request, shape (n,)."""
    lengths: Integers
    """Filled in, 0 where there is no datagram."""


@kernel
def write_messages(world: Table, due: Bytes, boxed: Boxed) -> None:
    """One frame: what all robots see of a world, as snapshots for the page and as datagrams of the requests due.

    world: WORLD, shape (1,); due: 1 for the requests that want a datagram, shape (n,); boxed: Desk.
    """
    desk: Desk = boxed.value
    sight, requests, ink, starts, lengths = desk.sight, desk.requests, desk.ink, desk.starts, desk.lengths
    sight.rays[:] = DIRECTIONS
    for k in range(len(requests)):
        if due[k]:
            viewer = requests[k].viewer
            sight.rays[viewer] = max(sight.rays[viewer], requests[k].rays)
    look_all(world, desk.place, sight)
    _write_views(world, sight, desk.page, ink.page_px, desk.views)
    for k in range(len(requests)):
        request = requests[k]
        seen = sight.seen[request.viewer]
        if not due[k] or seen.body < 0:
            starts[k] = lengths[k] = 0
            continue
        rays = sight.rays[request.viewer]
        kinds, px = sight.kinds[seen.start : seen.start + rays], ink.px[:rays]
        if rays == DIRECTIONS and not request.own_mirror:
            px = ink.page_px[request.viewer]
        else:
            mirror_px(sight.distances_m[seen.start :], request.a, request.b, request.c, request.d, px)
        starts[k], lengths[k] = write_see(world[0].at - desk.boot, seen, request, rays, kinds, px, k, ink)


@kernel
def _write_views(world: Table, sight: Sight, page: Table, page_px: Bytes, views: Table) -> None:
    """The views for the page, in the pixels of the field's mirror, ordered by team and number."""
    request, count = page[0], 0
    for viewer in range(VIEWERS):
        seen = sight.seen[viewer]
        if seen.body < 0:
            continue
        view = views[0].views[count]
        count += 1
        view.team, view.number = viewer // MAX_NUMBERS, viewer % MAX_NUMBERS + 1
        view.overlap, view.partial = seen.overlap, 0.0 < seen.ball_share < 1.0
        view.ball_px, view.ball_direction_deg, view.ball_size_deg = ball_words(seen, request)
        finer = sight.rays[viewer] // DIRECTIONS
        distances, kinds, px = sight.distances_m[seen.start :], sight.kinds[seen.start :], page_px[viewer]
        if finer == 1:  # compiled for neighbors in memory, which is three times as fast
            mirror_px(distances, request.a, request.b, request.c, request.d, px)
            _copy(kinds, view.kinds)
        else:
            mirror_px(distances[::finer], request.a, request.b, request.c, request.d, px)
            _copy(kinds[::finer], view.kinds)
        _copy(px, view.px)
    views[0].frame_number, views[0].at, views[0].count = world[0].frame_number, world[0].at, count


@kernel
def _copy(source: Bytes, target: Bytes) -> None:
    """Fill an array from the start of another. A slice would compile numba's message for slices of other lengths."""
    for index in range(len(target)):
        target[index] = source[index]


class Messages:
    """Observes and encodes. Holds memory, and nothing that one frame leaves to the next."""

    def __init__(self, settings: Settings, boot: Instant) -> None:
        self.eyes = Eyes(settings)
        self._boot = boot
        self.mirror = mirror_from(settings)
        """Of the field, for who asks for no other."""
        self.letters = LetterTable(**msgspec.structs.asdict(settings.protocol.letters))
        self._letters = np.array([letters_by_kind(self.letters, types) for types in TYPES])
        self._page: Table = np.zeros(1, dtype=REQUEST)
        self._page[0] = self.request(Team.BLUE, 1, PAPER_OPTIONS, nul=False)
        self.views = ViewsTable()
        """What the page shows of the last world."""
        self._page_px = np.zeros((VIEWERS, DIRECTIONS), dtype=np.uint8)
        self._prepare(())

    def write(self, world: WorldTable, clients: Sequence[Client], due: Bytes | None = None) -> Batch:
        """The datagrams of a world, one for each client that is due (None: all of them) and whose robot is there.

        They stay until the next call. Clients are looked at only when the sequence is another object than last time.
        due: 1 or 0 for each client; raises ValueError for another number of marks.
        """
        if clients is not self._clients:
            self._prepare(clients)
        due = self._all if due is None else due
        if len(due) != len(clients):
            raise ValueError(f"{len(due)} marks for {len(clients)} clients")
        write_messages(world.whole, due, self._boxed)
        return self._batch

    def request(self, team: Team, number: int, options: Options, *, nul: bool) -> Table:
        """A client's row for ``write_messages``. Raises ValueError when a view cannot have its directions."""
        rays = options.rays_per_circle
        per_deg = rays // 360
        sign = 1 if options.sense == "ccw" else -1
        mirror = options.mirror or self.mirror
        first, step = options.first_deg * per_deg, options.resolution_deg * per_deg
        if not (first.is_integer() and step.is_integer()):
            raise ValueError(
                f"directions every {options.resolution_deg:g} deg; accepted: every 1 / {TICKS_PER_DEG} deg"
            )
        row: Table = np.zeros(1, dtype=REQUEST)
        row[0] = (
            viewer_of(team, number), rays, sign * int(first) % rays, sign * int(step) % rays, options.directions,
            TYPES.index(options.types), options.sense == "cw", options.size == "half", options.time == "us", nul,
            mirror != self.mirror, options.fov_deg, options.center_deg, *_constants(mirror),
        )  # fmt: skip
        return row[0]  # type: ignore[no-any-return]

    def _prepare(self, clients: Sequence[Client]) -> None:
        """Take memory for so many clients and note what they want."""
        count = len(clients)
        self._clients = clients
        self._requests: Table = np.zeros(count, dtype=REQUEST)
        for row, client in enumerate(clients):
            init = client.init
            self._requests[row] = self.request(init.team, init.number, init.options, nul=client.nul)
        words = np.zeros(max(count, 1) * SLOT // 4, dtype=np.uint32)
        hex_words = np.frombuffer("".join(f"\0{value:02x}\0" for value in range(256)).encode(), dtype=np.uint32).copy()
        text = words.view(np.uint8)
        self.ink = Ink(hex_words, self._letters, text, words, np.zeros(MAX_RAYS, dtype=np.uint8), self._page_px)
        self._all = np.ones(count, dtype=np.uint8)
        self._batch = Batch(text, np.zeros(count, dtype=np.int64), np.zeros(count, dtype=np.int64))
        self._boxed = box(
            Desk(
                int(self._boot), self.eyes.place, self.eyes.sight, self._page, self.views.whole,
                self._requests, self.ink, self._batch.starts, self._batch.lengths,
            )
        )  # fmt: skip


def _constants(mirror: Mirror) -> tuple[float, float, float, float]:
    """A, B, C of equation 1, and D as ``Mirror.px_from_mm`` computes it."""
    return mirror.a, mirror.b, mirror.c, mirror.a**2 - mirror.b**2 * mirror.c
