"""The worlds of the experiment: two fields, two ceiling cameras, robots lower than the viewpoint or as high."""

import math
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

import numpy as np

from vision_core.capture.synthetic.world import Snapshot
from vision_core.geometry import Floats
from vision_core.models.from_settings import mirror_of, robots_of
from vision_core.models.hyperboloid import Hyperboloid
from vision_core.models.mirror import PAPER_MIRROR, Mirror
from vision_core.onboard.scene import snapshot_of
from vision_core.settings.schema import Settings
from vision_core.types.objects import Team
from vision_core.venues.loader import load_settings

VIEWER = (Team.BLUE, 1)
"""The robot that carries the camera; its pose is as random as the others'."""
LOW_M, TALL_M = 0.150, 0.220
"""Heights of robots: the paper's on-board camera, 219 mm high, looks over the first ones and not the second ones."""
GAP_RADII = 2.05
"""Least distance of two robots' centers, in their radii."""
LEAGUE_ZOOM = 2.3
"""The paper's mirror on a league-size field: so many pixels for one, which is what two digits allow."""

FIELDS: dict[str, dict[str, Any]] = {
    "3 m": {"field_preset": "ssl-2002"},
    "league": {"field_preset": "ssl-division-b", "camera.pinhole.position_m": [0.06, -0.04, 6.5]},
}
"""Settings of each field. A league's camera hangs higher: one camera for the whole field."""
CEILING_PX = {"640x480": (640, 480), "1280x1024": (1280, 1024)}
FOCAL_PX = {"3 m": (700.0, 1420.0), "league": (404.0, 808.0)}
"""Focal lengths at both sizes: the whole field is in the picture."""


ONBOARD_PX = {"3 m": (320, 240), "league": (640, 480)}
"""Sizes of the on-board picture: the paper's; on a league-size field far robots would be 3 px high in it."""


@dataclass(frozen=True, slots=True)
class Setup:
    """One kind of worlds and cameras."""

    field: str
    """A key of FIELDS."""
    ceiling: str
    """A key of CEILING_PX."""
    onboard_px: tuple[int, int]
    """Size of the on-board picture."""
    tall: bool
    """Robots are as high as the viewpoint; otherwise it looks over them."""

    @property
    def settings(self) -> Settings:
        """Nothing moves, nobody walks: the two pictures show the same instant."""
        return _settings(self.field, self.ceiling, tall=self.tall)

    @property
    def mirror(self) -> Mirror:
        """The field's, which looks down on a league-size field from 0.8 m; for tall robots the paper's, 219 mm high."""
        if self.tall and self.field == "league":
            return zoomed(PAPER_MIRROR, LEAGUE_ZOOM)
        return mirror_of(self.settings.mirror, VIEWER[0])


def zoomed(mirror: Mirror, zoom: float) -> Mirror:
    """The same mirror over a camera of another focal length: so many pixels for one."""
    shape = Hyperboloid.of(mirror)
    return replace(shape, focal_px=zoom * shape.focal_px).mirror()


@lru_cache(maxsize=16)
def _settings(field: str, ceiling: str, *, tall: bool) -> Settings:
    width, height = CEILING_PX[ceiling]
    focal = FOCAL_PX[field][list(CEILING_PX).index(ceiling)]
    return load_settings(
        options={
            "camera.width_px": width,
            "camera.height_px": height,
            "camera.pinhole.focal_px": focal,
            "camera.pinhole.center_px": [width / 2.0 - 1.8, height / 2.0 + 1.1],
            "robots.height_m": TALL_M if tall else LOW_M,
            "synthetic.walking_people": 0,
        }
        | FIELDS[field]
    )


def random_world(settings: Settings, seed: int) -> Snapshot:
    """Robots at random poses inside the lines, not in contact, and the ball anywhere outside of them."""
    rng = np.random.default_rng([seed, 12])
    radius = max(robots_of(settings.robots, team).radius_m for team in Team)
    half = np.array([settings.field.length_m, settings.field.width_m]) / 2.0
    count = 2 * settings.synthetic.robots_per_team
    places = np.empty((0, 2))
    while len(places) < count:
        place = rng.uniform(radius - half, half - radius)
        if _clear_of(places, place, GAP_RADII * radius):
            places = np.vstack([places, place])
    while True:
        ball = rng.uniform(settings.ball.radius_m - half, half - settings.ball.radius_m)
        if _clear_of(places, ball, radius + settings.ball.radius_m):
            break
    headings = rng.uniform(-math.pi, math.pi, (count, 1))
    return snapshot_of(np.hstack([places, headings]), (float(ball[0]), float(ball[1])))


def _clear_of(places: Floats, place: Floats, gap_m: float) -> bool:
    """Whether a place is at least so far from all others."""
    return bool((np.hypot(*(places - place).T) >= gap_m).all())
