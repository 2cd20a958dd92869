"""How far the painted lines lie beside their places: a calibration that is a little wrong shows here.

Every line is cut into sections. Across each, the brightness profile says how far aside of its place the paint lies.
One displacement per corner of the field, bilinear in between, is then fitted to all sections, and beside it how far a
lens bends the lines; sections that found something else (a robot, a wall) lose their weight. Where the displacement
is large, paint is searched again where it puts the lines. So one named point that is 15 px off shows as one corner
that is. ``shift_words`` says what follows from it.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from vision_core.geometry import Bytes, Floats, Mask, frozen
from vision_core.models.camera import CameraModel
from vision_core.models.field import painted_points
from vision_core.settings.schema import FieldSettings

POINTS_PER_LINE, POINTS_PER_SECTION = 60, 15
MIN_POINTS = 12
"""Points of a section that must lie in the picture."""
REACH_PX, REACH = 25, 0.05
"""Distance from its place at which paint is searched: in pixels, or as a share of the picture's height if that is more.
"""
MIN_ASIDE_PX = 3
"""Carpet is looked at this far beside the paint, or a line's width if that is more."""
MIN_CONTRAST = 10.0
"""Difference between paint and carpet on both of its sides [grey levels]."""
MAX_SECOND = 0.5
"""A second line in reach with more than this share of the contrast makes a section ambiguous."""
MIN_SECTIONS = 12
NOISE_PX, PRIOR_PX = 2.0, 15.0
"""Standard deviations of a section's offset and of a corner's displacement before anything was measured."""
FIXED_PX = 1e-3
"""Of something that is not fitted."""
BENT = 1.15
"""Lines are bent when so many times as many sections agree then."""
STEPS = 15
"""Reweighted least squares has settled by then."""
MIN_CERTAINTY = 3.0
"""A corner's displacement counts if it is this many times its standard deviation."""
CORNER_NAMES = ("left top", "right top", "right bottom", "left bottom")
CORNERS = np.array([(-1.0, 1.0), (1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)])
"""The field's corners in halves of its length and width, in the order of their names."""
GROWTHS = (0.1, -0.1)
SURE = 0.8
"""No other growth is tried when such a share of the pieces of lines agrees."""
BOW_STEPS = 9
"""Points along each axis of the field between which the largest bow is looked for."""
MAX_ROUNDS, SETTLED = 3, 0.4
"""Searches for paint; the last one is the one that moved nothing by more than this share of their reach."""


@dataclass(frozen=True, slots=True, eq=False)
class LineShifts:
    """Where the painted lines lie, compared with where the calibration puts them."""

    corners_px: Floats
    """The field's corners by the calibration, shape (4, 2), in the order of CORNER_NAMES."""
    shifts_px: Floats
    """From there to where the lines put them, shape (4, 2)."""
    certain: Mask
    """Whether the lines say enough about a corner, shape (4,)."""
    bow_px: float
    """How far a lens moves places of the field between its corners, where it does most: outwards from the picture's
    middle positive. 0 where the lines do not say it."""
    bow_at_m: tuple[float, float]
    """The place of the field where that is."""
    agreeing: int
    """Pieces of lines that lie where this puts them."""
    agreement: float
    """Their share of those that should be in the picture."""
    in_place: int
    """Pieces of lines that lie where the calibration puts them."""


@dataclass(frozen=True, slots=True, eq=False)
class _Section:
    """A piece of a line whose paint was found."""

    weights: Floats
    """Share of each corner's displacement here, shape (4,)."""
    place_px: Floats
    """Where the calibration puts it, shape (2,)."""
    normal: Floats
    """Unit vector across the line in the picture, shape (2,)."""
    offset_px: float
    """Distance of the paint from its place, along the normal."""


class _Motion:
    """What is fitted: a displacement of each corner of the field, x of the four, then y of them, and the bow [px]."""

    def __init__(self, field: FieldSettings, camera: CameraModel, shape: tuple[int, ...]) -> None:
        self.half_field = np.array([field.length_m, field.width_m]) / 2.0
        self.corners_px = camera.pixel_from_field(CORNERS * self.half_field)
        self._middle = np.array(shape[1::-1]) / 2.0
        self._scale = 1.0
        axis = np.linspace(-1.0, 1.0, BOW_STEPS)
        grid = np.stack(np.meshgrid(axis, axis), axis=-1).reshape(-1, 2)
        bows = self.bow(camera.pixel_from_field(grid * self.half_field), self.weights(grid * self.half_field))
        sizes = np.nan_to_num(np.hypot(*bows.T))
        self._scale = max(float(sizes.max()), 1e-9)
        x, y = (grid[sizes.argmax()] * self.half_field).tolist()
        self.bow_at_m: tuple[float, float] = (x, y)
        """The place of the field that a lens moves most."""

    def weights(self, points_m: Floats) -> Floats:
        """Share of each corner's displacement at points of the field, shape (n, 2) -> (n, 4)."""
        right, up = ((points_m / self.half_field + 1.0) / 2.0).T
        shares: Floats = np.column_stack(
            [(1.0 - right) * up, right * up, right * (1.0 - up), (1.0 - right) * (1.0 - up)]
        )
        return shares

    def bow(self, places: Floats, weights: Floats) -> Floats:
        """The displacement by a lens that bends lines, 1 px where it is largest; shapes (n, 2), (n, 4) -> (n, 2).

        It is radial and grows with the third power of the distance from the picture's middle, less what displacements
        of the corners explain: a camera from named points is right at these.
        """
        moved: Floats = (self._radial(places) - weights @ self._radial(self.corners_px)) / self._scale
        return moved

    def moves(self, places: Floats, weights: Floats, motion: Floats) -> Floats:
        """Displacements at places, shape (n, 2); motion: shape (9,)."""
        moved: Floats = weights @ motion[:8].reshape(2, 4).T + motion[8] * self.bow(places, weights)
        return moved

    def growing(self, growth: float) -> Floats:
        """The motion that makes the field larger by a share, shape (9,)."""
        away = growth * (self.corners_px - self.corners_px.mean(axis=0))
        return np.append(away.T.ravel(), 0.0)

    def design(self, places: Floats, weights: Floats, normals: Floats) -> Floats:
        """How displacements along normals depend on the motion, shape (n, 9)."""
        bows = (self.bow(places, weights) * normals).sum(axis=1)
        return np.column_stack([weights * normals[:, :1], weights * normals[:, 1:], bows])

    def _radial(self, places: Floats) -> Floats:
        arms = places - self._middle
        cubed: Floats = arms * (arms**2).sum(axis=1, keepdims=True)
        return cubed


def line_shifts(
    pixels: Bytes, field: FieldSettings, camera: CameraModel, *, is_thorough: bool = False
) -> LineShifts | None:
    """How the painted lines are displaced; None where too little of them is found.

    pixels: shape (height, width, 3), blue green red; is_thorough: where the lines found do not agree, try a field that
    is larger or smaller, too.
    """
    motion = _Motion(field, camera, pixels.shape)
    reach_px = max(REACH_PX, round(REACH * pixels.shape[0]))

    def search(moved: Floats) -> list[_Section | None]:
        return list(_sections(pixels, field, camera, motion, moved, reach_px))

    still = search(motion.growing(0.0))
    in_place = sum(section is not None and abs(section.offset_px) <= NOISE_PX for section in still)
    best: LineShifts | None = None
    for growth in (0.0, *GROWTHS) if is_thorough else (0.0,):
        moved = motion.growing(growth)
        found = _shifts_from(search, motion, moved, still if growth == 0.0 else search(moved), reach_px, in_place)
        if found is not None and (best is None or found.agreeing > best.agreeing):
            best = found
        if best is not None and best.agreement >= SURE:
            break
    return best


def _shifts_from(
    search: Callable[[Floats], list[_Section | None]], motion: _Motion, moved: Floats,
    searched: list[_Section | None], reach_px: int, in_place: int,
) -> LineShifts | None:  # fmt: skip
    """The displacement by the lines found where a first motion puts them, searched again where that leads.

    searched: what was found there; in_place: pieces of lines that lie where the calibration puts them.
    """
    for number in range(MAX_ROUNDS):
        searched = search(moved) if number else searched
        sections = [section for section in searched if section is not None]
        if len(sections) < MIN_SECTIONS:
            return None
        before, (moved, deviations, agreeing) = moved, _fit(sections, motion)
        if np.abs(moved - before).max() <= SETTLED * reach_px:
            break
    shifts = moved[:8].reshape(2, 4).T
    lengths, doubts = np.hypot(*shifts.T), np.hypot(deviations[:4], deviations[4:8])
    return LineShifts(
        corners_px=motion.corners_px,
        shifts_px=shifts,
        certain=frozen((lengths < NOISE_PX) | (lengths > MIN_CERTAINTY * doubts)),
        bow_px=float(moved[8]) if abs(moved[8]) > MIN_CERTAINTY * deviations[8] else 0.0,
        bow_at_m=motion.bow_at_m,
        agreeing=agreeing,
        agreement=agreeing / len(searched),
        in_place=in_place,
    )


def _fit(sections: Sequence[_Section], motion: _Motion) -> tuple[Floats, Floats, int]:
    """The motion that explains the sections and its deviations, shape (9,) each; how many sections agree with it.

    Lines are taken to be bent only where that explains clearly more.
    """
    straight, bent = (_fitted(sections, motion, prior) for prior in (FIXED_PX, PRIOR_PX))
    return bent if bent[2] >= BENT * straight[2] else straight


def _fitted(sections: Sequence[_Section], motion: _Motion, bow_px: float) -> tuple[Floats, Floats, int]:
    """``_fit`` with a prior deviation of the bow."""
    places, weights = np.array([s.place_px for s in sections]), np.array([s.weights for s in sections])
    design = motion.design(places, weights, np.array([s.normal for s in sections]))
    offsets = np.array([s.offset_px for s in sections])
    prior = np.diag([(NOISE_PX / PRIOR_PX) ** 2] * 8 + [(NOISE_PX / bow_px) ** 2])
    trust = np.ones(len(sections))
    for _ in range(STEPS):
        information = design.T @ (design * trust[:, None]) + prior
        moved = np.asarray(np.linalg.solve(information, design.T @ (offsets * trust)), dtype=np.float64)
        rest = np.abs(offsets - design @ moved)
        trust = np.minimum(NOISE_PX / np.maximum(rest, NOISE_PX), 1.0) ** 2
    deviations: Floats = NOISE_PX * np.sqrt(np.diag(np.linalg.inv(information)))
    return moved, deviations, int((rest <= NOISE_PX).sum())


def _sections(
    pixels: Bytes, field: FieldSettings, camera: CameraModel, motion: _Motion, moved: Floats, reach_px: int
) -> Iterator[_Section | None]:  # fmt: skip
    """The sections in the picture, each searched where a motion puts it; None for one whose paint is not found."""
    line_width_px = field.line_width_m * camera.pixels_per_metre((0.0, 0.0)) if field.line_width_m else math.inf
    if not line_width_px <= reach_px:
        return
    size = np.array(pixels.shape[1::-1])
    for line in painted_points(field, POINTS_PER_LINE):
        places = camera.pixel_from_field(line)
        along = np.gradient(places, axis=0)
        weights = motion.weights(line)
        shifts = motion.moves(places, weights, moved)
        with np.errstate(invalid="ignore", divide="ignore"):
            normals = np.column_stack([-along[:, 1], along[:, 0]]) / np.hypot(along[:, 0], along[:, 1])[:, None]
            there = places + shifts
            usable = np.asarray(((there >= 0.0) & (there <= size - 1.0) & np.isfinite(normals)).all(axis=1))
        for start in range(0, len(line), POINTS_PER_SECTION):
            chosen = np.flatnonzero(usable[start : start + POINTS_PER_SECTION]) + start
            if len(chosen) < MIN_POINTS:
                continue
            offset_px = _paint_offset(pixels, there[chosen], normals[chosen], line_width_px, reach_px)
            if offset_px is None:
                yield None
                continue
            normal = normals[chosen].mean(axis=0)
            offset_px += float(shifts[chosen].mean(axis=0) @ normal)
            yield _Section(weights[chosen].mean(axis=0), places[chosen].mean(axis=0), normal, offset_px)


def _paint_offset(
    pixels: Bytes, places: Floats, normals: Floats, line_width_px: float, reach_px: int
) -> float | None:  # fmt: skip
    """Distance of the paint nearest to a line's place; None where there is none, or two lines.

    places, normals: points of a section and unit vectors across it, shape (n, 2).
    """
    offsets = np.arange(-reach_px, reach_px + 1.0)
    height, width = pixels.shape[:2]
    x, y = np.moveaxis((places + normals * offsets[:, None, None]).round().astype(np.intp), -1, 0)
    brightness = pixels[np.clip(y, 0, height - 1), np.clip(x, 0, width - 1)].mean(axis=-1)
    profile = np.median(brightness, axis=1)
    half_width = max(1, round(line_width_px / 2.0))
    box = np.full(2 * half_width - 1, 1.0 / (2 * half_width - 1))
    smooth = np.convolve(np.pad(profile, half_width - 1, mode="edge"), box, mode="valid")
    aside = max(math.ceil(line_width_px), MIN_ASIDE_PX)
    if 2 * aside >= len(offsets):
        return None
    contrast = smooth[aside:-aside] - np.maximum(smooth[: -2 * aside], smooth[2 * aside :])
    best = int(contrast.argmax())
    others = contrast[np.abs(np.arange(len(contrast)) - best) > aside + half_width]
    if contrast[best] < MIN_CONTRAST or others.max(initial=0.0) > MAX_SECOND * contrast[best]:
        return None
    return float(offsets[best + aside])
