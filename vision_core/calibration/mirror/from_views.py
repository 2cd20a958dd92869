"""Pairs from one on-board picture and what is known to stand around the robot: hundreds at once.

While the ceiling camera measures where a robot and everything around it stands, its own camera takes a picture: in
every direction the distance of the nearest solid's foot is known. A ray through the picture shows several edges: paint
on the floor, the foot, the upper edge, what lies behind. The feet are those that one mirror explains in most
directions, and they have the floor on their inner side: of many mirrors through two such edges each the one that meets
an edge on most rays is taken, and then fitted.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from vision_core.calibration.mirror.fit import STARTS_PX, FocalPrior, fit_mirror, radii_of
from vision_core.calibration.mirror.lines import mirrors_through, radii_through
from vision_core.calibration.mirror.pairs import MAX_BYTES, Pairs, SharedError, pairs_of
from vision_core.calibration.mirror.rounding import Rounding
from vision_core.calibration.mirror.table import DIRECTIONS, rows_of
from vision_core.calibration.mirror.target_edge import (
    MIN_RADIUS_PX,
    STEP_PX,
    Point,
    Profile,
    edges_of,
    middle_of,
    profile_along,
)
from vision_core.calibration.result import Progress, no_progress
from vision_core.errors import SettingsError, SourceError
from vision_core.geometry import Bytes, Floats
from vision_core.models.mirror import MAX_PX, MM_PER_M
from vision_core.types.views import RobotView
from vision_core.user_files import read_text

MAX_EDGES = 8
"""Of one ray: the innermost ones."""
FLOOR_SHARES = (0.2, 0.75)
"""Between these shares of half the picture's shorter side most of what is seen is floor."""
COLOR_STEP, COLOR_SIGMAS = 24.0, 3.0
"""How far from the floor's usual color it may be: grey levels at least, and deviations."""
GUESSES, SEED = 1500, 1
"""Mirrors through two edges that are tried for each focal length, the same in every call."""
NEAR_PX, MATCH_PX = 2.0, 1.5
"""An edge belongs to a mirror that was guessed, or fitted, when it lies so near to it [px of equation 1]."""
BESIDE, BEYOND, LINE = 10, 6, 26
"""Steps of a ray: the floor is seen so far inside of an edge, and at a line's edge between so far beyond it."""
RING_PX, RING_SHARE = 0.75, 0.6
"""Edges within so much of one radius, on so many of the rays, are the mirror's rim or the robot's own body."""
TOLD = 60
"""Directions between two reports of progress."""
REFINED = 3
"""Rounds of fitting the mirror and taking the nearest edges."""
GIVEN_MM, MEASURED_MM, EDGE_PX = 2.5, 0.5, 0.1
"""Errors that all pairs of pictures share: of distances that somebody gives, who may not know what is painted along the
walls; of those that the ceiling camera measures on a known field; of edges, in pixels of the picture."""
MIN_SHARE, MIN_MATCHED = 0.4, 12
"""Of the directions, and of how many, must show an edge where the mirror has it."""


@dataclass(frozen=True, slots=True, eq=False)
class Surroundings:
    """What stands around a robot: the nearest solid's foot in directions anticlockwise from the robot's heading."""

    directions_rad: Floats
    """Shape (n,)."""
    distances_mm: Floats
    """On the floor from the robot's center, shape (n,); inf where nothing stands."""
    shared_mm: float = GIVEN_MM
    """Standard deviation of an error that all distances share."""

    @classmethod
    def of(cls, view: RobotView) -> "Surroundings":
        """Those of a robot by the ceiling camera's measurement."""
        count = len(view.distances_m)
        directions = math.tau / count * np.arange(count, dtype=np.float64)
        return cls(directions, view.distances_m * MM_PER_M, MEASURED_MM)

    @classmethod
    def read(cls, path: Path) -> "Surroundings":
        """Those of a file. Raises SettingsError."""
        asked = f"surroundings {path}"
        return cls.from_text(read_text(path, asked, SettingsError, max_bytes=MAX_BYTES), asked)

    @classmethod
    def from_text(cls, text: str, asked: str) -> "Surroundings":
        """Those of CSV with directions [deg] and distances [mm] (``table``). asked: what messages call it.

        Raises SettingsError naming its line.
        """
        rows = rows_of(text, DIRECTIONS, asked)
        directions, distances = np.array([row.values for row in rows]).T
        if not (distances > 0.0).all():
            line = rows[int(np.argmax(distances <= 0.0))].line
            raise SettingsError(f"{asked}, line {line}", found="no distance", accepted="more than 0 mm")
        return cls(np.radians(directions), distances)

    def known(self) -> "Surroundings":
        """Without the directions in which nothing stands."""
        known = np.isfinite(self.distances_mm)
        return Surroundings(self.directions_rad[known], self.distances_mm[known], self.shared_mm)


@dataclass(frozen=True, slots=True, eq=False)
class PairsAround:
    """What a picture shows around a robot."""

    pairs: Pairs
    directions_rad: Floats
    """Of each pair, anticlockwise from the heading, shape (n,)."""


def pairs_around(
    pixels: Bytes,
    around: Surroundings,
    *,
    center_px: Point | None = None,
    scale: float = 1.0,
    name: str = "the picture",
    progress: Progress = no_progress,
) -> PairsAround:
    """The pairs that an on-board picture shows, shape (height, width, 3).

    center_px: of the mirror's image; None: the picture's middle. scale: pixels of the picture per pixel of equation 1;
    name: what messages call the picture. Raises SourceError when no mirror explains what stands around the robot.
    """
    known = around.known()
    _check(len(known.distances_mm), len(known.distances_mm), name)
    center = middle_of(pixels) if center_px is None else center_px
    profiles = []
    for number, direction in enumerate(known.directions_rad.tolist()):
        if number % TOLD == 0:
            progress(f"looking for edges in {name}", 0.5 * number / len(known.directions_rad))
        profiles.append(profile_along(pixels, center, direction, (MIN_RADIUS_PX, MAX_PX * scale)))
    progress(f"matching the edges in {name}", 0.5)
    edges = _without_rings(_floor_ends(profiles, center, min(pixels.shape[:2]) / 2.0) / scale)
    predicted = _guessed(edges, known.distances_mm)
    shared = SharedError(known.shared_mm, EDGE_PX / scale)
    found = _nearest(edges, predicted, NEAR_PX, known, name, shared)
    for _ in range(REFINED):
        _check(len(found.pairs), len(edges), name)
        predicted = radii_of(fit_mirror(found.pairs, FocalPrior()).shape, known.distances_mm)
        found = _nearest(edges, predicted, MATCH_PX, known, name, shared)
    _check(len(found.pairs), len(edges), name)
    return found


def _floor_ends(profiles: Sequence[Profile], center_px: Point, reach_px: float) -> Floats:
    """Radii [px of the picture] of the edges at which the floor ends, shape (n, MAX_EDGES), innermost first; nan where
    there are fewer. The floor does not end at painted lines: beyond a line there is floor again.

    The floor is the color that most places have which are neither near to the center nor far out. reach_px: from the
    center to the picture's nearer border.
    """
    radii = np.full((len(profiles), MAX_EDGES), np.nan)
    low, high = (share * reach_px for share in FLOOR_SHARES)
    floor, spread = _commonest(
        np.concatenate([one.colors[(one.radii_px >= low) & (one.radii_px <= high)] for one in profiles])
    )
    for row, profile in zip(radii, profiles, strict=True):
        with np.errstate(invalid="ignore"):
            is_floor = np.abs(profile.colors - floor).max(axis=1) <= spread
        ends = []
        for edge in edges_of(profile, center_px):
            place = round((edge.radius_px - float(profile.radii_px[0])) / STEP_PX)
            is_end = is_floor[max(place - BESIDE, 0)] and not is_floor[place + BEYOND : place + LINE].any()
            ends += [edge.radius_px] if is_end else []
        row[: len(ends)] = ends[:MAX_EDGES]
    return radii


def _commonest(colors: Floats) -> tuple[Floats, float]:
    """The most frequent color of many, shape (n, 3) -> (3,), and how far others of its kind may be from it."""
    colors = colors[np.isfinite(colors).all(axis=1)]
    if not len(colors):
        return np.zeros(3), 0.0
    boxes = (colors // COLOR_STEP).astype(np.int64)
    _, kinds, counts = np.unique(boxes, axis=0, return_inverse=True, return_counts=True)
    around = colors[kinds.ravel() == int(np.argmax(counts))].mean(axis=0)
    near = colors[np.abs(colors - around).max(axis=1) <= COLOR_STEP]
    floor: Floats = near.mean(axis=0)
    return floor, max(COLOR_STEP, COLOR_SIGMAS * float(near.std(axis=0).max()))


def _without_rings(edges_px: Floats) -> Floats:
    """The edges without those of the mirror's rim and the robot's own body, which stand at one radius all around."""
    left = edges_px.copy()
    for radius in np.arange(MIN_RADIUS_PX, MAX_PX, RING_PX):
        with np.errstate(invalid="ignore"):
            near = np.abs(edges_px - radius) <= RING_PX
        if near.any(axis=1).mean() > RING_SHARE:
            left[near] = np.nan
    return left


def _guessed(edges_px: Floats, distances_mm: Floats) -> Floats:
    """Radii of all directions, shape (n,), by the mirror through two edges that meets edges on most rays.

    edges_px: shape (n, MAX_EDGES), nan where there are fewer.
    """
    rows, columns = np.nonzero(np.isfinite(edges_px))
    guesses, met = [np.full((1, len(edges_px)), np.nan)], [np.zeros(1)]
    random = np.random.default_rng(SEED)
    for focal in STARTS_PX if len(rows) else ():
        two = random.integers(0, len(rows), (GUESSES, 2))
        a, b = mirrors_through(edges_px[rows[two], columns[two]], distances_mm[rows[two]], focal)
        guesses.append(radii_through(a, b, focal, distances_mm))
        met.append(_met(edges_px, guesses[-1]))
    best: Floats = np.concatenate(guesses)[int(np.argmax(np.concatenate(met)))]
    return best


def _met(edges_px: Floats, guesses_px: Floats) -> Floats:
    """On how many rays each guess meets an edge, near misses counting less: shapes (n, MAX_EDGES), (m, n) -> (m,)."""
    score = np.zeros(guesses_px.shape)
    for column in edges_px.T:
        score = np.fmax(score, 1.0 - ((guesses_px - column) / NEAR_PX) ** 2)
    met: Floats = score.sum(axis=1)
    return met


def _nearest(
    edges_px: Floats, predicted_px: Floats, reach_px: float, known: Surroundings, name: str, shared: SharedError
) -> PairsAround:
    """The edges nearest to a mirror's radii, where they are near."""
    off = np.abs(edges_px - predicted_px[:, None])
    off[~np.isfinite(off)] = np.inf
    nearest = off.argmin(axis=1)
    rows = np.flatnonzero(off.min(axis=1) <= reach_px)
    pairs = [(float(edges_px[row, nearest[row]]), float(known.distances_mm[row])) for row in rows.tolist()]
    directions = known.directions_rad[rows]
    names = [f"{name} at {degree:.0f} degrees" for degree in np.degrees(directions)]
    return PairsAround(pairs_of(pairs, names, Rounding.EXACT, [shared] * len(pairs)), directions)


def _check(matched: int, of: int, name: str) -> None:
    if matched < max(MIN_MATCHED, MIN_SHARE * of):
        raise SourceError(
            f"the edges in {name}",
            found=f"in {matched} of {of} directions one at a distance that a mirror explains",
            accepted=f"{MIN_SHARE:.0%} of them and {MIN_MATCHED} at least: the robot's heading up in the picture, left"
            " at the left, the center right, and nothing moved",
        )
