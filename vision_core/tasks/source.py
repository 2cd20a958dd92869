"""Task: plays the camera when the source is no device: it renders the simulated field, or reads files.

A real camera makes its images without using the service's time, so this task has no real-time priority. It makes the
image that ``capture`` requested, in the slot of the ring that the request names, and reports when it is done. A source
that fails is opened again once a second. The live settings ``[faults]`` spoil its images on the way. Before each image
of a simulated match the robots' drivers are heard.
"""

from typing import TYPE_CHECKING

import numpy as np

from vision_core.capture.faults import FaultySource
from vision_core.capture.source import PlayedSource, open_played
from vision_core.clock import NS_PER_S, Instant, after
from vision_core.errors import SourceError
from vision_core.rtdb import records
from vision_core.rtdb.infos import FrameDone, LiveSettings
from vision_core.scheduling.handle import Handle, Step
from vision_core.scheduling.releases import IDLE, RAN
from vision_core.settings.schema import SYNTHETIC
from vision_core.tasks.capture import REOPEN_EVERY_S, info_of
from vision_core.timing.rate_keeper import RequestedKeeper
from vision_core.types.drives import drives_from

if TYPE_CHECKING:
    from vision_core.capture.synthetic.world import World

REPORT_EVERY_S = 0.2
"""Between two reports of the game."""


def start(handle: Handle) -> Step:
    """Open the file, or build the simulated world."""
    player = _Player(handle)
    player.fill()
    handle.every_turn(player.reopen)
    return lambda _release: RAN if player.fill() else IDLE


class _Game:
    """The simulated match: hears the robots' drivers, and reports what happens."""

    def __init__(self, handle: Handle, world: "World") -> None:
        self._clock = handle.clock
        self._world = world
        self._drives = handle.raw_reader(records.DRIVES.name)
        self._report = handle.writer(records.GAME)
        self._reported = Instant(0)
        self._games: int | None = None

    def go_on(self, live: LiveSettings) -> None:
        """To be called before each image: follow the newest commands, and begin a new game if the operator says so."""
        now = self._clock.now()
        drives = self._drives.read(now)
        if drives is not None:
            self._world.drive(drives_from(drives.value), live.match, now)
        if self._games not in (None, live.games):
            self._world.begin_game()
        self._games = live.games
        if now >= after(self._reported, REPORT_EVERY_S):
            self._reported = now
            self._report.write(self._world.game, now, now)


def _game_of(handle: Handle, played: PlayedSource) -> _Game | None:
    """The match of a source, if it is simulated."""
    if handle.settings.source.uri != SYNTHETIC:
        return None
    from vision_core.capture.synthetic.camera import SyntheticCamera

    assert isinstance(played, SyntheticCamera)
    return _Game(handle, played.world)


class _Player:
    """Makes the requested images."""

    def __init__(self, handle: Handle) -> None:
        camera = handle.camera
        self._handle = handle
        self._shape = camera.shape
        self._frames = handle.raw_reader(f"frames/{camera.name}")
        self._requests = handle.reader(records.frame_requests(camera.name))
        self._done = handle.writer(records.frames_done(camera.name))
        self._info = handle.writer(records.source(camera.name))
        self._live_reader = handle.reader(records.LIVE_SETTINGS)
        self._live_sequence = 0
        self._live = LiveSettings.of(handle.settings)
        self._game: _Game | None = None
        self._source: FaultySource | None = None
        self._keeper = RequestedKeeper(camera.rate_hz)
        self._opened = Instant(0)
        self._filled = 0
        """Sequence number of the newest request that is done."""
        done = handle.reader(records.frames_done(camera.name)).read(handle.clock.now())
        request = self._requests.read(handle.clock.now())
        if done and request and done.value.number == request.value.number:
            self._filled = request.sequence  # by a predecessor, which perhaps ended before it released capture
            handle.notify(self._done.name)

    def reopen(self) -> None:
        """Try again to open a source that could not be read."""
        if self._source is None:
            self.fill()

    def fill(self) -> bool:
        """Make the image of the newest request; False when that is done already or cannot be done."""
        try:
            source = self._source or self._open()
            timed = self._requests.read(self._handle.clock.now())
            if source is None or timed is None or timed.sequence == self._filled:
                return False
            request = timed.value
            self._take_live_settings(source)
            if self._game is not None:
                self._game.go_on(self._live)
            self._keeper.request(request.instant)
            source.grab(np.frombuffer(self._frames.payload(request.slot), dtype=np.uint8).reshape(self._shape))
        except SourceError as error:
            self._source, self._handle.note = None, str(error)
            return False
        self._filled, now = timed.sequence, self._handle.clock.now()
        self._done.write(FrameDone(request.number), now, now)
        self._handle.notify(self._done.name)
        self._handle.note = ""
        return True

    def _take_live_settings(self, source: FaultySource) -> None:
        if self._live_reader.sequence == self._live_sequence:
            return
        self._live_sequence, live = self._live_reader.sequence, self._live_reader.read(self._handle.clock.now())
        if live is not None:
            before, self._live = self._live, live.value
            if self._live.faults != before.faults:
                source.have(self._live.faults)

    def _open(self) -> FaultySource | None:
        """Open the source, at most once a second; None in between. Raises SourceError."""
        now = self._handle.clock.now()
        if now - self._opened < REOPEN_EVERY_S * NS_PER_S:
            return None
        self._opened = now
        played = open_played(self._handle.settings, self._handle.camera, self._handle.clock, paced=False)
        self._game = _game_of(self._handle, played)
        source = FaultySource(played, self._live.faults)
        source.prepare()
        source.keeper = self._keeper = RequestedKeeper(source.rate_hz)
        self._info.write(info_of(source, self._handle.settings.source.uri), now, now)
        self._handle.notify(self._info.name)
        self._source = source
        return source
