"""Every setting, declared once: type, range and meaning. The values stand in ``config/default.toml``.

Structs are frozen, refuse unknown keys, and carry a unit in every name. ``venues.loader`` loads and
merges the files; the web side shows the JSON schema made from these declarations.
"""

from typing import Annotated, Literal

from msgspec import Meta, Struct


class Record(Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Base of all settings."""


S_PER_MS = 1e-3
Share = Annotated[float, Meta(ge=0.0, le=1.0)]
Positive = Annotated[float, Meta(gt=0.0, le=1e6)]
NotNegative = Annotated[float, Meta(ge=0.0, le=1e6)]
Port = Annotated[int, Meta(ge=0, le=65535)]
Degrees = Annotated[float, Meta(ge=-360.0, le=720.0)]
Gain = Annotated[float, Meta(gt=0.0, le=64.0)]
Level = Annotated[float, Meta(ge=0.0, le=255.0)]
HexColor = Annotated[str, Meta(pattern="^#[0-9a-fA-F]{6}$", description="#rrggbb")]
HostName = Annotated[str, Meta(min_length=1, max_length=253)]
Name = Annotated[str, Meta(max_length=40)]
Point2 = tuple[float, float]
Point3 = tuple[float, float, float]


class ServerSettings(Record, frozen=True):
    """Addresses and ports at which the service listens."""

    host: Annotated[str, Meta(min_length=1, description="address of the web page")]
    udp_host: Annotated[str, Meta(description="address of the UDP ports; empty: the same as host")]
    port: Annotated[Port, Meta(description="TCP port of the web page")]
    udp_port: Annotated[Port, Meta(description="UDP port where clients send their init")]
    session_port: Annotated[Port, Meta(description="UDP port of all sessions; 0: udp_port + 1")]
    viewers: Annotated[
        Literal["open", "closed"], Meta(description="open: anybody may look at the page; closed: who has logged in")
    ]
    hosts: Annotated[tuple[HostName, ...], Meta(description="further names under which the page may be asked for")]


SYNTHETIC = "synthetic"
"""``source.uri`` of the simulated camera."""


class SourceSettings(Record, frozen=True):
    """The source of images."""

    uri: Annotated[
        str, Meta(description="synthetic, file:<picture, folder or video> or camera:<n, path, name=.. or serial=..>")
    ]

    @property
    def kind(self) -> str:
        """The word before the colon; each kind needs kernels of its own."""
        return self.uri.partition(":")[0]

    @property
    def device(self) -> str | None:
        """The camera that the address names, as of ``capture.devices``; None: no device, images are made on request."""
        kind, _, device = self.uri.partition(":")
        return device if kind == "camera" and device else None


class PinholeSettings(Record, frozen=True):
    """Lens and pose of a calibrated camera."""

    focal_px: Positive
    center_px: Point2
    distortion: Annotated[tuple[float, float, float, float, float], Meta(description="k1 k2 p1 p2 k3")]
    position_m: Annotated[Point3, Meta(description="optical center in the field")]
    rotation_deg: Annotated[Point3, Meta(description="about the camera's x, y, z; 0 0 0 looks straight down")]


class LensSettings(Record, frozen=True):
    """A lens that was measured with a board: it holds when the camera's pose is calibrated by painted lines."""

    size_px: Annotated[tuple[int, int], Meta(description="width and height of the pictures")]
    focal_px: Positive
    center_px: Point2
    distortion: Annotated[tuple[float, float, float, float, float], Meta(description="k1 k2 p1 p2 k3")]
    focal_deviation_px: Annotated[Positive, Meta(description="standard deviation: how well it is known")]
    center_deviation_px: tuple[Positive, Positive]
    distortion_deviation: Annotated[tuple[Positive, Positive, Positive, Positive], Meta(description="of k1 k2 p1 p2")]


class NamedPoint(Record, frozen=True):
    """A point of the floor with its pixel in the picture and its place on the field."""

    name: str
    pixel_px: Point2
    field_m: Point2


class HomographySettings(Record, frozen=True):
    """A camera from named points of the floor."""

    points: Annotated[tuple[NamedPoint, ...], Meta(min_length=4)]
    position_m: Annotated[Point3, Meta(description="optical center in the field, by tape measure")]


class MaskSettings(Record, frozen=True):
    """A polygon in the picture in which nothing is looked for: spectators, a scoreboard."""

    name: Annotated[Name, Meta(min_length=1)]
    points_px: Annotated[tuple[Point2, ...], Meta(min_length=3, max_length=32, description="its corners, x and y")]


class CameraSettings(Record, frozen=True):
    """One ceiling camera."""

    name: Annotated[str, Meta(pattern="^[a-z][a-z0-9_]{0,15}$")]
    width_px: Annotated[int, Meta(ge=64, le=8192)]
    height_px: Annotated[int, Meta(ge=64, le=8192)]
    rate_hz: Annotated[float, Meta(gt=0.0, le=1000.0)]
    shutter_delay_ms: Annotated[float, Meta(ge=0.0, le=1000.0)]
    model: Literal["pinhole", "homography"]
    pinhole: PinholeSettings
    masks: Annotated[tuple[MaskSettings, ...], Meta(max_length=16)]
    homography: HomographySettings | None = None
    lens: LensSettings | None = None


class DriveSettings(Record, frozen=True):
    """What simulated robots can do that clients' programs drive."""

    wheels: Annotated[Literal["omni", "two"], Meta(description="two: no robot drives sideways")]
    speed_m_s: Annotated[float, Meta(gt=0.0, le=20.0, description="highest speed that a program may ask for")]
    turn_rad_s: Annotated[float, Meta(gt=0.0, le=100.0, description="highest turn rate that it may ask for")]
    acceleration_m_s2: Annotated[float, Meta(gt=0.0, le=100.0)]
    turn_acceleration_rad_s2: Annotated[float, Meta(gt=0.0, le=1000.0)]
    kick_m_s: Annotated[float, Meta(ge=0.0, le=20.0, description="fastest kick; 0: no kicker")]
    dribbler: bool
    silence_ms: Annotated[float, Meta(gt=0.0, le=10000.0, description="after so long without a command a robot stops")]

    @property
    def sideways_m_s(self) -> float:
        """Highest speed to the left and right."""
        return self.speed_m_s if self.wheels == "omni" else 0.0


class SyntheticSettings(Record, frozen=True):
    """The simulated ceiling camera: the match that it shows, its noise and its light."""

    seed: Annotated[int, Meta(ge=0, le=4_294_967_295)]
    robots_per_team: Annotated[int, Meta(ge=0, le=16)]
    speed_m_s: Annotated[float, Meta(ge=0.0, le=10.0)]
    exposure_ms: Annotated[float, Meta(ge=0.0, le=100.0)]
    read_noise: Annotated[float, Meta(ge=0.0, le=64.0)]
    shot_noise: Annotated[float, Meta(ge=0.0, le=8.0)]
    vignetting: Share
    uneven_light: Share
    brightness: Annotated[float, Meta(gt=0.0, le=4.0)]
    shadows: Share
    clutter: bool
    walking_people: Annotated[int, Meta(ge=0, le=20)]
    drive: DriveSettings


class LightFaultSettings(Record, frozen=True):
    """Another light, another curve of the camera, a poor connection."""

    gain_bgr: Annotated[tuple[Gain, Gain, Gain], Meta(description="of the light in blue, green and red")]
    black: Annotated[float, Meta(ge=0.0, le=128.0, description="level added to every channel")]
    gamma: Annotated[float, Meta(ge=0.2, le=5.0, description="levels become 255 (level / 255)^gamma")]
    right_half: Annotated[float, Meta(ge=0.0, le=4.0, description="share of the light on the picture's right half")]
    noise: Annotated[float, Meta(ge=0.0, le=64.0, description="standard deviation in grey levels")]
    jpeg_quality: Annotated[int, Meta(ge=0, le=100, description="0: not compressed")]


class FaultSettings(Record, frozen=True):
    """Faults of a source that is no device, to try what happens."""

    light: LightFaultSettings


class GoalSettings(Record, frozen=True):
    """Both goals."""

    width_m: NotNegative
    depth_m: NotNegative


class FieldSettings(Record, frozen=True):
    """The field's measures: from the outer edge of one line to the outer edge of the opposite one."""

    name: str
    length_m: Annotated[float, Meta(gt=0.2, le=30.0)]
    width_m: Annotated[float, Meta(gt=0.2, le=30.0)]
    margin_m: Annotated[float, Meta(ge=0.0, le=5.0, description="from the line to the wall or limit")]
    walls: Annotated[bool, Meta(description="walls are solid; without them the limit is virtual")]
    wall_height_m: Annotated[float, Meta(ge=0.0, le=1.0)]
    corner_cut_m: Annotated[float, Meta(ge=0.0, le=1.0)]
    line_width_m: Annotated[float, Meta(ge=0.0, le=0.2, description="0: no lines are painted")]
    center_circle_radius_m: NotNegative
    penalty_depth_m: NotNegative
    penalty_width_m: NotNegative
    goal: GoalSettings


class MirrorConstants(Record, frozen=True):
    """A, B, C of equation 1, for distances in millimetres."""

    a: float
    b: float
    c: float


class MirrorSettings(MirrorConstants, frozen=True):
    """The mirror of the field's robots, and those of teams and single robots which have their own."""

    blue: MirrorConstants | None = None
    yellow: MirrorConstants | None = None
    robots: Annotated[
        dict[str, MirrorConstants],
        Meta(description='of single robots, by team and number: [mirror.robots."blue 3"]; before that of the team'),
    ] = {}


class ColorRange(Record, frozen=True):
    """A box in the color space; axes that are left out are not limited. A range of angles may wrap: (350, 10)."""

    hue_deg: tuple[Degrees, Degrees] | None = None
    saturation: tuple[Share, Share] | None = None
    value: tuple[Share, Share] | None = None
    phase_deg: tuple[Degrees, Degrees] | None = None
    module: Annotated[tuple[float, float] | None, Meta(description="0..181")] = None
    luma: Annotated[tuple[float, float] | None, Meta(description="0..255")] = None


class LightSettings(Record, frozen=True):
    """The light of the color tuning, and how pictures are adapted to it: (pixel - black) * gain."""

    adapt: Annotated[bool, Meta(description="false: pictures and colors stay as they were set up")]
    black_bgr: Annotated[tuple[Level, Level, Level], Meta(description="the sensor's level in the dark")]
    band: Annotated[
        tuple[Share, Share], Meta(description="samples that are averaged: quantiles from the darkest to the brightest")
    ]
    white_balance: Annotated[bool, Meta(description="a gain of its own for every channel; otherwise one for all three")]
    margin_m: Annotated[
        float, Meta(ge=-1.0, le=1.0, description="samples are taken up to this far outside the walls or limits")
    ]
    gain_bgr: Annotated[tuple[Gain, Gain, Gain], Meta(description="gains of the pictures of the set-up themselves")]
    dead_band: Annotated[
        float, Meta(ge=0.0, le=0.5, description="logarithm up to which gains stay those of the set-up")
    ]
    max_gain: Annotated[float, Meta(ge=1.0, le=64.0, description="the largest gain; the smallest is its inverse")]
    max_shift: Annotated[
        float,
        Meta(gt=0.0, le=4.0, description="how far log B/G and log R/G of a paint may get from where they were set up"),
    ]
    reference_bgr: Annotated[
        tuple[Level, Level, Level] | None,
        Meta(description="mean color of these samples over black, in the venue's light; left out: not measured"),
    ] = None


class SamplingSettings(Record, frozen=True):
    """How near a color must be to the samples of a class to be of it."""

    spread: Annotated[
        float,
        Meta(gt=0.0, le=2.0, description="deviation of log B/G and log R/G within a class of few samples"),
    ]
    tolerance: Annotated[
        float, Meta(gt=0.0, le=20.0, description="a color farther than so many spreads from a class is not of it")
    ]


class ColorSettings(Record, frozen=True):
    """Color classes, by boxes or by samples. Where boxes of two classes overlap, the class listed first wins."""

    space: Annotated[
        Literal["hsv", "ymp", "ec"],
        Meta(description="hsv: hue, saturation, value; ymp: luma, module, phase; ec: luma, hue, saturation"),
    ]
    classes: dict[str, tuple[ColorRange, ...]]
    samples: dict[str, tuple[HexColor, ...]]
    sampling: SamplingSettings
    light: LightSettings


class BlobSettings(Record, frozen=True):
    """Segmentation: which blobs are kept, the size of its buffers, how much of the picture is searched."""

    min_area_px: Annotated[int, Meta(ge=1, le=1_000_000, description="smaller blobs are noise")]
    max_runs: Annotated[int, Meta(ge=100, le=10_000_000)]
    max_blobs: Annotated[int, Meta(ge=10, le=1_000_000)]
    row_step: Annotated[
        float,
        Meta(ge=0.01, le=1.0, description="distance of the rows that are searched, as a share of the smallest dot"),
    ]
    scan_band: Annotated[
        float, Meta(ge=0.001, le=1.0, description="share of the picture searched per frame beside the windows")
    ]
    max_flood_fraction: Annotated[
        float,
        Meta(ge=0.0, le=1.0, description="share of the picture that blobs may cover; above it every pixel is read"),
    ]


class RobotShape(Record, frozen=True):
    """A robot's body and the height of its marker: set by its pattern's file, a venue may override it."""

    outline: Annotated[Literal["circle", "square"], Meta(description="of the robot's body, seen from above")]
    radius_m: Annotated[float, Meta(gt=0.005, le=1.0, description="of the circle, or half the side of the square")]
    height_m: Annotated[float, Meta(ge=0.0, le=2.0, description="of the markers over the floor")]


PatternIds = Annotated[
    tuple[tuple[int, ...], ...],
    Meta(max_length=4, description="where pattern is a list: the ids that are worn of each; empty: all"),
]


class WornSettings(RobotShape, frozen=True):
    """What robots wear."""

    pattern: Annotated[
        str | Annotated[tuple[str, ...], Meta(min_length=1, max_length=4)],
        Meta(description="file in config/patterns, without its ending; a list: robots of a team wear different ones"),
    ]

    @property
    def patterns(self) -> tuple[str, ...]:
        """The names of all patterns that the robots wear."""
        return (self.pattern,) if isinstance(self.pattern, str) else self.pattern


class TeamRobotSettings(WornSettings, frozen=True):
    """The robots of a team that has its own."""

    pattern_ids: PatternIds = ()


class RobotSettings(WornSettings, frozen=True):
    """Robots and how they are recognized."""

    min_area: Annotated[float, Meta(gt=0.0, description="smallest area of a dot as a share of the predicted one")]
    max_area: Annotated[float, Meta(gt=0.0)]
    margin_m: Annotated[float, Meta(ge=-1.0, le=5.0, description="how far outside the walls or limits robots may be")]
    dot_tolerance_m: Annotated[
        float, Meta(gt=0.0, le=0.1, description="largest distance of a dot from its place in the marker")
    ]
    min_confidence: Share
    circle_floor_px: Annotated[
        float,
        Meta(
            ge=0.001, le=5.0, description="standard deviation of a round patch's center in addition to that of its fit"
        ),
    ]
    polygon_floor_px: Annotated[float, Meta(ge=0.001, le=5.0, description="the same for other patches")]
    pattern_ids: PatternIds
    blue: TeamRobotSettings | None = None
    yellow: TeamRobotSettings | None = None


class BallSettings(Record, frozen=True):
    """The ball, and which blobs may be one."""

    color: Annotated[str, Meta(description="name of a color class")]
    radius_m: Annotated[float, Meta(gt=0.002, le=0.5)]
    min_area: Annotated[float, Meta(gt=0.0, description="smallest area as a share of the predicted one")]
    max_area: Annotated[float, Meta(gt=0.0)]
    max_elongation: Annotated[float, Meta(ge=1.0, description="longer side of its box over the shorter one")]
    min_fill: Annotated[Share, Meta(description="least share of its box that it fills")]
    surrounding: Annotated[tuple[str, ...], Meta(description="color classes that must surround it; empty: any")]
    min_surrounding: Share
    inside_robot_m: Annotated[float, Meta(ge=0.0, description="nearer to a robot's center than this it is no ball")]
    min_confidence: Share


class ObstacleSettings(Record, frozen=True):
    """Things on the field that are neither robots nor ball."""

    difference: Annotated[float, Meta(gt=0.0, le=255.0, description="from the carpet, in grey levels")]
    min_radius_m: Annotated[float, Meta(gt=0.0, le=1.0)]
    max_radius_m: Annotated[float, Meta(gt=0.0, le=5.0)]


class TrackSettings(Record, frozen=True):
    """Kalman filters and when tracks end."""

    validity_ms: Annotated[float, Meta(gt=0.0, le=10000.0, description="a robot unseen for longer is gone")]
    ball_validity_ms: Annotated[float, Meta(gt=0.0, le=10000.0)]
    obstacle_validity_ms: Annotated[
        float, Meta(gt=0.0, le=10000.0, description="an obstacle unseen for longer is gone")
    ]
    gate_m: Annotated[float, Meta(gt=0.0, le=2.0)]
    robot_acceleration_m_s2: Positive
    robot_turn_acceleration_rad_s2: Positive
    ball_acceleration_m_s2: Positive
    robot_noise_m: Positive
    heading_noise_rad: Positive
    ball_noise_m: Positive


class ViewSettings(Record, frozen=True):
    """Views of robots."""

    r_min_m: Annotated[float, Meta(ge=0.0, description="nearest distance reported; 0: the robot's own radius")]


class ProtocolSettings(Record, frozen=True):
    """The protocol between server and clients."""

    letters: Annotated[
        dict[str, str],
        Meta(description="edge types on the wire whose letter differs from the table of edge types, by name"),
    ]
    lease_s: Annotated[float, Meta(gt=0.0, description="a version-1 client silent for longer is dropped")]


Network = Annotated[str, Meta(max_length=64, description="an address or a subnet, 192.168.1.0/24")]
MAX_RULES = 256
"""Most entries of each list of ``[admission]``: all of them are looked at for each datagram of a stranger."""


class AdmissionRule(Record, frozen=True):
    """Addresses that may connect, and for which robots: those of a team, or the one of a number; left out: all."""

    network: Network
    team: Literal["blue", "yellow"] | None = None
    number: Annotated[int, Meta(ge=1, le=16)] | None = None


class AdmissionSettings(Record, frozen=True):
    """Addresses that may connect; in practice the server's own machine may as well."""

    subnets: Annotated[tuple[Network, ...], Meta(max_length=MAX_RULES, description="may connect as every robot")]
    rules: Annotated[tuple[AdmissionRule, ...], Meta(max_length=MAX_RULES, description="may connect as some robots")]
    refused: Annotated[
        tuple[Network, ...], Meta(max_length=MAX_RULES, description="may not connect, whatever the other lists say")
    ]
    open_practice: Annotated[
        bool, Meta(description="in practice, every address of a local network may connect as every robot")
    ]


PlayMode = Literal[
    "before_kick_off", "play_on", "kick_off_l", "kick_off_r", "kick_in_l", "kick_in_r", "free_kick_l", "free_kick_r",
    "corner_kick_l", "corner_kick_r", "goal_kick_l", "goal_kick_r", "goal_l", "goal_r", "penalty_kick_l",
    "penalty_kick_r", "drop_ball", "first_half_over", "pause", "time_over",
]  # fmt: skip
"""SoccerServer's words; l and r are the sides that the teams defend."""


class MatchViews(Record, frozen=True):
    """The views of all robots in a match, whatever their programs ask for. Other options stay the clients' choice."""

    types: Annotated[
        Literal["same", "team", "number"], Meta(description="whether an edge names a robot's team and number")
    ]
    fov_deg: Annotated[float, Meta(gt=0.0, le=360.0, description="width of the field of view")]
    center_deg: Annotated[float, Meta(ge=-360.0, le=360.0, description="its middle; 180 for the full circle")]
    resolution_deg: Annotated[float, Meta(gt=0.0, le=360.0, description="between two directions")]
    rate_hz: Annotated[int, Meta(ge=0, le=1000, description="at most so many views a second; 0: every frame")]


class MatchSettings(Record, frozen=True):
    """What a match fixes, the same for both teams."""

    mode: Annotated[
        Literal["practice", "match"], Meta(description="match: who only looks on sees everything viewer_delay_s late")
    ]
    play_mode: Annotated[PlayMode, Meta(description="SoccerServer's word, told to clients in the answer to init")]
    viewer_delay_s: Annotated[float, Meta(ge=0.0, le=60.0, description="in a match, for viewers")]
    blue_name: Annotated[Name, Meta(description="of the team in blue; empty: it is called blue")]
    yellow_name: Name
    numbers: Annotated[int, Meta(ge=1, le=16, description="robots per team that may connect")]
    blue_defends: Annotated[Literal["left", "right"], Meta(description="left is the goal at negative x")]
    blue_ids: Annotated[tuple[Annotated[int, Meta(ge=0, le=255)], ...], Meta(description="marker id of blue 1, 2, ...")]
    yellow_ids: Annotated[
        tuple[Annotated[int, Meta(ge=0, le=255)], ...], Meta(description="marker id of yellow 1, 2, ...")
    ]
    views: MatchViews

    def ids_of(self, team: str) -> tuple[int, ...]:
        """Marker ids of a team's robots 1, 2, ...; team: blue or yellow."""
        return self.blue_ids if team == "blue" else self.yellow_ids

    @property
    def fixes_views(self) -> bool:
        """All robots see alike: through one mirror, and with the options of ``views``."""
        return self.mode == "match"


class TaskTimes(Record, frozen=True):
    """When a task runs, and with which priority."""

    priority: Annotated[int, Meta(ge=0, le=90, description="SCHED_FIFO 1..90; 0: an ordinary process")]
    period_ms: Annotated[float, Meta(ge=0.0, le=3.6e6, description="0: with every writing of its trigger")]
    budget_ms: Annotated[float, Meta(ge=0.0, le=3.6e6, description="a longer run is an overrun; 0: none is counted")]
    offset_ms: Annotated[float, Meta(ge=0.0, le=3.6e6, description="of the period's grid")] = 0.0
    enabled: bool = True
    cores: Annotated[tuple[Annotated[int, Meta(ge=0, le=1023)], ...], Meta(description="empty: any")] = ()
    rehearse: Annotated[
        bool, Meta(description="repeat the last run shortly before the next, for warm caches, if the task can")
    ] = True

    @property
    def period_s(self) -> float:
        """Of a periodic task; of a task that a record releases, the least time between two runs. 0: every release."""
        return self.period_ms * S_PER_MS

    @property
    def offset_s(self) -> float:
        """Of the period's grid, from the start of the service."""
        return self.offset_ms * S_PER_MS

    @property
    def budget_s(self) -> float:
        """A run that takes longer is an overrun; 0: none is counted."""
        return self.budget_ms * S_PER_MS


class TaskSettings(TaskTimes, frozen=True):
    """One line of ``[tasks]``: a task's times. With a module it is a task of the user's own."""

    process: Annotated[str, Meta(description="tasks that name the same one share it; empty: its own")] = ""
    module: Annotated[str, Meta(description="of a task of your own: has start(handle)")] = ""
    trigger: Annotated[str, Meta(description="of a task of your own: period, or a record that it reads")] = "period"
    reads: tuple[str, ...] = ()
    writes: tuple[str, ...] = ()

    @property
    def times(self) -> TaskTimes:
        """The times alone, as ``Task`` and ``TaskInfo`` have them."""
        return TaskTimes(**{name: getattr(self, name) for name in TaskTimes.__struct_fields__})


class Settings(Record, frozen=True):
    """Everything."""

    field_preset: Annotated[str, Meta(description="file in config/fields, without its ending")]
    server: ServerSettings
    source: SourceSettings
    camera: CameraSettings
    synthetic: SyntheticSettings
    faults: FaultSettings
    field: FieldSettings
    mirror: MirrorSettings
    colors: ColorSettings
    blobs: BlobSettings
    robots: RobotSettings
    ball: BallSettings
    obstacles: ObstacleSettings
    tracks: TrackSettings
    views: ViewSettings
    tasks: Annotated[dict[str, TaskSettings], Meta(description="by name")]
    protocol: ProtocolSettings
    admission: AdmissionSettings
    match: MatchSettings
