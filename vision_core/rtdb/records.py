"""Names, types and codecs of all records in the database.

| record | written by | contains |
| --- | --- | --- |
| service | supervisor | version, start, addresses, the settings |
| processes | supervisor | state of every process, and of a restart of the service |
| restart_request | web | that the service is to be restarted |
| frames/<camera> | capture | the newest images |
| source/<camera> | capture | the camera's name, rate and kind |
| sightings/<camera> | perceive | robots and balls of one frame |
| obstacles/<camera> | obstacles | things that are no known robot |
| diagnosis/<camera> | diagnose | why nothing or too little is seen |
| overlay/<camera> | overlay | what is drawn over the picture, while somebody looks |
| world | serve | tracks at the frame's instant |
| views | serve | what every robot would see, as it is sent |
| serving | serve | clients, rates and lags |
| sessions | serve | the state from which a restarted ``serve`` continues with the same clients |
| boundary/<camera> | boundary | where the field ends in the image |
| lines/<camera> | lines | whether the painted lines are where they should be |
| exposure/<camera> | exposure | how light the field is |
| colors/<camera> | colors | how far the light has drifted from the venue's |
| palette/<camera> | follow | the colors in force while they follow the light |
| suggestions/<camera> | search | robots that the blobs do not show |
| frame_requests/<camera> | capture | which image a simulated camera or a file is to deliver next |
| frames_done/<camera> | source | that this image is in its slot |
| fairness | serve | how every robot was served since the match began: see ``types.fairness`` |
| fairness_ended | serve | the newest record of fairness that has ended |
| drives | serve | the newest command of each robot's driver |
| game | source | score, possession and collisions of a simulated match |
| lags | serve | histograms of the lags of server, network and clients |
| log | log_reader | the newest lines that the processes printed: see ``log_record`` |
| selftest | supervisor | how well this machine keeps time |
| live_settings | web | the settings that hold from the next frame on |
| looking | web | until when somebody looks at an overlay, and at which layers |
| task/<task> | each task | its times, policy and metrics |
| timing/<task> | each task | its histograms |
| heartbeat/<process> | each process | nothing: its age shows that the process is alive |
"""

import msgspec

from vision_core.rtdb.infos import (
    LAGS,
    TIMINGS,
    FrameDone,
    FrameRequest,
    LiveSettings,
    Processes,
    RestartRequest,
    SelfTest,
    ServiceInfo,
    Serving,
    SourceInfo,
    TaskInfo,
)
from vision_core.rtdb.items import AnyRecord, CameraRecord, Item, packed, per_camera, per_camera_table, tabled
from vision_core.rtdb.layout import RecordSpec
from vision_core.timing.histogram import size_of
from vision_core.types import drives
from vision_core.types.fairness import FAIRNESS
from vision_core.types.game import Game
from vision_core.types.objects import Diagnosis, Obstacles, Sightings
from vision_core.types.overlay import Looking, Overlay
from vision_core.types.palette import LivePalette
from vision_core.types.regions import BodyContours, ColorDrift, ExposureCheck, FieldBoundary, Finding, LineCheck
from vision_core.types.suggestions import LiveSuggestions
from vision_core.types.tables import SightingsTable, ViewsTable, WorldTable
from vision_core.types.tracks import World
from vision_core.types.views import Views

WATCHED_S = 2.0
"""Validity of the records of watchers: with the default settings each runs every 0.8 s or more often. The record of a
watcher that is slowed further is invalid between two runs."""
SERVICE = packed("service", ServiceInfo, 196608, 0.0)
PROCESSES = Item(  # JSON, since the supervisor is standard library only
    RecordSpec("processes", 16384, 3.0), msgspec.json.Encoder(), msgspec.json.Decoder(Processes)
)
RESTART_REQUEST = Item(
    RecordSpec("restart_request", 512, 0.0), msgspec.json.Encoder(), msgspec.json.Decoder(RestartRequest)
)
WORLD: Item[World] = tabled("world", WorldTable, 0.25)
VIEWS: Item[Views] = tabled("views", ViewsTable, 0.25)
SERVING = packed("serving", Serving, 65536, 2.0)
SESSIONS = RecordSpec("sessions", 65536, 0.0)
DRIVES = RecordSpec("drives", drives.SIZE, 0.0)
GAME = packed("game", Game, 4096, 2.0)
LAG_HISTOGRAMS = RecordSpec("lags", size_of(LAGS), 2.0)
FAIRNESS_RECORD = RecordSpec("fairness", FAIRNESS.itemsize, 0.0)
FAIRNESS_ENDED = RecordSpec("fairness_ended", FAIRNESS.itemsize, 0.0)
LIVE_SETTINGS = packed("live_settings", LiveSettings, 65536, 0.0)
LOOKING = packed("looking", Looking, 256, 0.0)
SELF_TEST = packed("selftest", SelfTest, 2048, 0.0)
MAX_OVERLAY = 393216
"""Size of an overlay [bytes]; ``pipeline.overlay`` keeps within it."""

MAX_PALETTE = 98304
"""Size of a palette [bytes]: 64 KiB are its classes."""


source = per_camera("source", SourceInfo, 16384, 0.0)
sightings: CameraRecord[Sightings] = per_camera_table("sightings", SightingsTable, 0.25)
obstacles = per_camera("obstacles", Obstacles, 16384, 0.5)
diagnosis = per_camera("diagnosis", Diagnosis, 16384, 5.0)
boundary = per_camera("boundary", Finding[FieldBoundary], 16384, WATCHED_S)
lines = per_camera("lines", Finding[LineCheck], 4096, WATCHED_S)
exposure = per_camera("exposure", Finding[ExposureCheck], 4096, WATCHED_S)
colors = per_camera("colors", Finding[ColorDrift], 4096, WATCHED_S)
contours = per_camera("contours", Finding[BodyContours], 65536, 0.5)
palette = per_camera("palette", LivePalette, MAX_PALETTE, 0.0)
suggestions = per_camera("suggestions", LiveSuggestions, 8192, 3.0)
overlay = per_camera("overlay", Overlay, MAX_OVERLAY, 3.0)
frame_requests = per_camera("frame_requests", FrameRequest, 256, 0.0)
frames_done = per_camera("frames_done", FrameDone, 256, 0.0)

CATALOG: tuple[AnyRecord, ...] = (
    PROCESSES,
    SELF_TEST,
    source,
    sightings,
    obstacles,
    boundary,
    lines,
    exposure,
    colors,
    palette,
    contours,
    diagnosis,
    WORLD,
    VIEWS,
    SERVING,
    GAME,
    LIVE_SETTINGS,
)
"""Everything that a person may want to look at: ``vision_core.rtdb.catalog`` reads all of it at one instant. A record
that is added here can be shown on the page."""
HANDSHAKE = (frame_requests, frames_done)
"""Records of each camera that only the tasks ``capture`` and ``source`` need."""


def task(name: str) -> Item[TaskInfo]:
    return packed(f"task/{name}", TaskInfo, 8192, 2.0)


def timing(name: str) -> RecordSpec:
    """The histograms TIMINGS of a task; see ``vision_core.timing.histogram``."""
    return RecordSpec(f"timing/{name}", size_of(TIMINGS), 2.0)


def heartbeat(process: str) -> RecordSpec:
    """Written ten times a second by a process that is alive; its payload is empty."""
    return RecordSpec(f"heartbeat/{process}", 8, 1.0)


def frames(camera: str, width_px: int, height_px: int) -> RecordSpec:
    """The ring of images: blue green red, row by row."""
    return RecordSpec(f"frames/{camera}", width_px * height_px * 3, 0.25, checksum=False)
