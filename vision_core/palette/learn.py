"""What the paints and the floor look like, from pictures in which robots are read."""

from collections.abc import Mapping, Sequence
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from vision_core.color.samples import Measured, distances
from vision_core.geometry import Bytes, Floats, Mask, rotation
from vision_core.models.camera_kernels import pixel_from_field
from vision_core.models.from_settings import robots_of
from vision_core.objects.robots.marker_shape import score_of
from vision_core.objects.robots.shape_search import measure_colors
from vision_core.palette.naming import PAINT_SD, SCALE_SD, SHIFT_SD, USUAL_SCALE
from vision_core.palette.trial import BALL, BALL_RADII, ROBOT_RADII, Judged, Kind, Picture, Trial
from vision_core.settings.schema import SamplingSettings
from vision_core.types.colors import DARK_LEVEL, LUMA_BGR, chromaticity
from vision_core.types.tables import TEAMS

Row: TypeAlias = Any
"""One row of a table."""

LEARNED = SamplingSettings(spread=0.12, tolerance=3.5)
"""How near a color must be to what was learned."""
SURE, CLEAR = 0.25, 0.5
"""Robots whose markers are shown so clearly teach their colors; the surroundings of these are no floor."""
MIN_DISC = 0.15
"""How clear a disc must be, times how well its hue agrees, to be taken for the ball."""
DARKEST_DISC = 0.3
"""A disc with a smaller share of the luma that is expected is no ball: near black every hue may be noise."""
SHADES = 3
"""Samples of one patch."""
MAX_SAMPLES = 24
"""Per paint."""
MAX_FLOOR = 80
"""Samples of the floor."""
FLOOR_SHARE = 4e-3
"""A color that so small a share of the field has is not listed."""
TOP_SHARE = 0.04
"""The same for the tops of robots."""
FLOOR_CHROMA, FLOOR_LUMA = 0.08, 0.15
"""Colors nearer than this to a listed one, in chromaticity and in the luma's logarithm, are taken to be the same."""
PALE_CHROMA, PALE_SHARE = 0.2, 0.6
"""The floor looks like a pale paint when its chromaticity is so near and it is at least so light."""
GUESSED_LUMA = 70.0
"""Of paints when none was seen."""
UNSEEN_SHARES = 0.75, 1.0, 1.25
"""A paint that was not seen may be so much paler or purer than the others suggest."""
RARE_SHARE, DOUBT = 0.01, 3.0
"""A color of the floor that has a smaller share of it and lies within so many spreads of a paint may be a robot that
was missed: it is not listed."""
ALIKE = 2.0
"""Beside the field no robot is missed: there only a color within so many spreads of a paint is not listed."""


def learn(
    trial: Trial, pictures: Sequence[Picture], judged: Sequence[Judged], *, ball_as_read: bool = False
) -> tuple[Measured, NDArray[np.int64]]:
    """The palette that pictures show, and how many patches of each paint were seen; shape (paints,).

    ball_as_read: what is read as the ball is believed when it is a disc, which is quicker than to search for discs, and
    right when the palette was.
    """
    shown: list[list[Floats]] = [[] for _ in trial.paints]
    counts = np.zeros(len(trial.paints), dtype=np.int64)
    floor, tops = [], []
    for picture, seen in zip(pictures, judged, strict=True):
        for robot, evidence in zip(seen.robots, seen.evidence, strict=True):
            kind = trial.kind_of(robot)
            if evidence < SURE:
                continue
            if kind.template.has_between:
                tops.append(_region_of(trial, picture.pixels, robot, kind.template.patches))
            row = kind.ids.index(int(robot["id"])) if len(kind.ids) > 1 else 0
            for patch, paint in enumerate(kind.worn[row]):
                shown[paint] += _shades_of(_region_of(trial, picture.pixels, robot, patch))
                counts[paint] += 1
        floor.append(_floor_of(trial, picture, seen))
    ball = trial.kinds[BALL].worn[0, 0]
    expected = placed_by_name(trial, shown)[ball, 1]
    for picture, seen in zip(pictures, judged, strict=True):
        own_ball = _ball_color(trial, picture, seen, expected, as_read=ball_as_read)
        shown[ball] += own_ball
        counts[ball] += len(own_ball)
    placed = placed_by_name(trial, shown)
    classes = {
        name: _spread_out(np.array(colors)) if colors else placed[number]
        for number, (name, colors) in enumerate(zip(trial.paints, shown, strict=True))
    }
    colors, shares = floor_samples(np.concatenate(floor))
    if tops:
        own, parts = floor_samples(np.concatenate(tops), TOP_SHARE)
        colors, shares = np.concatenate([colors, own]), np.concatenate([shares, parts])
    doubt = np.where(shares >= RARE_SHARE, 0.0, DOUBT)
    beyond, _ = floor_samples(np.concatenate([_beyond(trial, picture) for picture in pictures]))
    beyond = beyond[[not (color == colors).all(axis=1).any() for color in beyond]]
    colors, doubt = np.concatenate([colors, beyond]), np.concatenate([doubt, np.full(len(beyond), ALIKE)])
    near = distances(colors, Measured(classes, colors[:0]), LEARNED).min(axis=1) < doubt
    return Measured(classes, without_colorless(trial, colors[~near], classes)), counts


def without_colorless(trial: Trial, floor: Floats, classes: Mapping[str, Floats]) -> Floats:
    """Samples of the floor without those that look like a white or pale paint: such paints are told by their shape."""
    kept = np.ones(len(floor), dtype=np.bool_)
    for name, colorless in zip(trial.paints, trial.colorless, strict=True):
        if colorless:
            own = classes[name]
            near = ((chromaticity(floor)[:, None] - chromaticity(own)) ** 2).sum(axis=-1).min(axis=1) < PALE_CHROMA**2
            kept &= ~(near & (floor @ LUMA_BGR > PALE_SHARE * float((own @ LUMA_BGR).min())))
    left: Floats = floor[kept]
    return left


def placed_by_name(trial: Trial, shown: Sequence[Sequence[Floats]]) -> Floats:
    """Where each paint is expected by its name in the light that the others are seen in; shape (paints, samples, 3)."""
    typical = chromaticity(trial.typical)
    # scale and shift of the typical paints: least squares with priors; rows x, then y
    rows: list[list[float]] = []
    wanted: list[float] = []
    for number, colors in enumerate(shown):
        if len(colors):
            place = np.median(chromaticity(np.array(colors)), axis=0)
            rows += [[typical[number, 0], 1.0, 0.0], [typical[number, 1], 0.0, 1.0]]
            wanted += place.tolist()
    prior = np.diag([PAINT_SD / SCALE_SD, PAINT_SD / SHIFT_SD, PAINT_SD / SHIFT_SD])
    wanted += [USUAL_SCALE * float(prior[0, 0]), 0.0, 0.0]
    scale, *shift = np.linalg.lstsq(np.vstack([*rows, prior]), np.array(wanted), rcond=None)[0]
    usual = trial.typical @ LUMA_BGR
    light = [float(np.median(np.array(c) @ LUMA_BGR)) / luma for c, luma in zip(shown, usual, strict=True) if len(c)]
    lumas = usual * float(np.median(light)) if light else GUESSED_LUMA
    return np.stack([bgr_from_chromaticity(share * scale * typical + shift, lumas) for share in UNSEEN_SHARES], axis=1)


def bgr_from_chromaticity(places: Floats, luma: float | Floats = GUESSED_LUMA) -> Floats:
    """Colors with some chromaticities, shape (n, 2) -> (n, 3), of one luma or one each, shape (n,).

    Channels may lie outside of 0..255.
    """
    ratios = np.exp(np.column_stack([places[:, 0], np.zeros(len(places)), places[:, 1]]))
    scale = (luma + DARK_LEVEL) / (ratios @ LUMA_BGR)
    colors: Floats = ratios * scale[:, None] - DARK_LEVEL
    return colors


def _ball_color(trial: Trial, picture: Picture, seen: Judged, expected: Floats, *, as_read: bool) -> list[Floats]:
    """The color of a picture's ball, or none: of the clearest disc beside the robots whose hue may be the ball's.

    expected: the ball's color by its name, blue, green, red; as_read: as of ``learn``.
    """
    kind, best, color = trial.kinds[BALL], MIN_DISC, None

    def fit_of(score: float, shown: Floats) -> float:
        if shown @ LUMA_BGR < DARKEST_DISC * (expected @ LUMA_BGR):
            return 0.0
        away = float(np.hypot(*(chromaticity(shown) - chromaticity(expected))))
        return score * float(np.exp(-0.5 * (away / PAINT_SD) ** 2))

    for ball in seen.balls[:1] if as_read else ():
        place = float(ball["x_m"]), float(ball["y_m"])
        score = score_of(picture.scene, trial.camera_map, kind.template, kind.height_m, *place, 0.0, 1.0)
        shown = _colors_at(trial, picture.pixels, kind, np.array([score, *place, 0.0, 1.0]))[0]
        if fit_of(score, shown) > MIN_DISC and not _is_on_a_robot(trial, seen, *place):
            return [shown]
    for disc in trial.shapes(picture, kind):
        score, x, y = disc.poses[0, :3]
        fit = fit_of(float(score), disc.colors[0, 0])
        if fit > best and not _is_on_a_robot(trial, seen, float(x), float(y)):
            best, color = fit, disc.colors[0, 0]
    return [] if color is None else [color]


def _is_on_a_robot(trial: Trial, seen: Judged, x_m: float, y_m: float) -> bool:
    for robot in seen.robots:
        radius = robots_of(trial.settings.robots, TEAMS[robot["team"]]).radius_m
        if np.hypot(robot["x_m"] - x_m, robot["y_m"] - y_m) < radius:
            return True
    return False


def _colors_at(trial: Trial, pixels: Bytes, kind: Kind, pose: Floats) -> Floats:
    """Mean colors of the patches of a marker, or the ball, at a pose; shape (patches, 3)."""
    colors = np.zeros((kind.template.patches, 3))
    measure_colors(pixels, trial.camera_map, kind.template, kind.height_m, pose, colors)
    return colors


def _spread_out(colors: Floats) -> Floats:
    """At most MAX_SAMPLES of the colors, every n-th by luma."""
    if len(colors) <= MAX_SAMPLES:
        return colors
    ordered = colors[np.argsort(colors @ LUMA_BGR)]
    chosen: Floats = ordered[np.linspace(0, len(ordered) - 1, MAX_SAMPLES).round().astype(int)]
    return chosen


def _floor_of(trial: Trial, picture: Picture, seen: Judged) -> Floats:
    """Colors of the field where neither a robot nor the ball is, shape (n, 3)."""
    pixels, places = trial.floor_px, trial.floor_m
    free: Mask = trial.is_field.copy()
    for robot, evidence in zip(seen.robots, seen.evidence, strict=True):
        if evidence >= CLEAR:
            radius = ROBOT_RADII * robots_of(trial.settings.robots, TEAMS[robot["team"]]).radius_m
            free &= np.hypot(places[:, 0] - robot["x_m"], places[:, 1] - robot["y_m"]) > radius
    for ball in seen.balls[:1]:
        radius = BALL_RADII * trial.settings.ball.radius_m
        free &= np.hypot(places[:, 0] - ball["x_m"], places[:, 1] - ball["y_m"]) > radius
    colors: Floats = picture.pixels[pixels[free, 1], pixels[free, 0]].astype(np.float64)
    return colors


def _beyond(trial: Trial, picture: Picture) -> Floats:
    """Colors beside the field, as far as robots are accepted; shape (n, 3)."""
    pixels = trial.floor_px[~trial.is_field]
    colors: Floats = picture.pixels[pixels[:, 1], pixels[:, 0]].astype(np.float64)
    return colors


def _region_of(trial: Trial, pixels: Bytes, robot: Row, region: int) -> Floats:
    """Colors of the points of a region of a robot's template, those in the picture; shape (n, 3)."""
    kind = trial.kind_of(robot)
    height, width, _ = pixels.shape
    turn = rotation(robot["heading_rad"])
    found = []
    for point in kind.template.points_m[region]:
        x, y = turn @ point
        u, v = pixel_from_field(trial.camera_map, robot["x_m"] + x, robot["y_m"] + y, kind.height_m)
        if 0.0 <= u < width - 1.0 and 0.0 <= v < height - 1.0:
            found.append(pixels[round(v), round(u)])
    return np.array(found, dtype=np.float64).reshape(-1, 3)


def _shades_of(colors: Floats) -> list[Floats]:
    """The mean of a patch's darkest, middle and lightest colors, shape (n, 3): lamps light no paper evenly."""
    ordered = colors[np.argsort(colors @ LUMA_BGR)]
    return [part.mean(axis=0) for part in np.array_split(ordered, SHADES) if len(part)]


def floor_samples(colors: Floats, least_share: float = FLOOR_SHARE) -> tuple[Floats, Floats]:
    """The colors that stand for those of the floor, the most frequent first: shape (n, 3) -> (at most MAX_FLOOR, 3).

    With each the share of the floor that it stands for.
    """
    cells, counts = np.unique((colors // 8.0).astype(np.int64) @ np.array([1, 32, 1024]), return_counts=True)
    order = np.argsort(-counts, kind="stable")
    cells, counts = cells[order], counts[order]
    centers = np.column_stack([cells % 32, cells // 32 % 32, cells // 1024]) * 8.0 + 3.5
    places = np.column_stack([chromaticity(centers) / FLOOR_CHROMA, np.log(centers @ LUMA_BGR + 4.0) / FLOOR_LUMA])
    left = np.ones(len(cells), dtype=np.bool_)
    chosen: list[int] = []
    shares: list[float] = []
    for number in range(len(cells)):
        if len(chosen) == MAX_FLOOR:
            break
        if not left[number]:
            continue
        near = left & (((places - places[number]) ** 2).sum(axis=1) < 1.0)
        if counts[near].sum() >= least_share * len(colors):
            chosen.append(number)
            shares.append(float(counts[near].sum()) / len(colors))
        left &= ~near
    found: Floats = centers[chosen]
    return found, np.array(shares)
