"""Judges a lens from a board: how much of the picture was covered, how sure it is, and why it is refused."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import combinations

import numpy as np

from vision_core.calibration.board.corners import BoardView
from vision_core.calibration.board.result import BoardPicture, LensCalibration
from vision_core.calibration.board.solve import LENS, LensFit, held_out_px, rms
from vision_core.calibration.certainty import inside_hull
from vision_core.geometry import Floats
from vision_core.settings.schema import LensSettings
from vision_core.types.reasons import Reason

MIN_PICTURES = 4
"""With a board in them."""
MIN_TILT_DEG, MIN_BETWEEN_DEG = 10.0, 15.0
"""Least tilt of one board, and least angle between two: otherwise nothing tells the focal length from the distance."""
MIN_REGION = 0.15
"""Share of a ninth of the picture from which on it counts as covered."""
MAX_RMS_PX, MAX_RMS = 1.0, 0.0012
"""Largest rms distance: in pixels, or as a share of the picture's longer side."""
MAX_HELD_OUT_PX, MAX_HELD_OUT = 2.0, 0.0025
"""The same of one picture by the lens of all others."""
MAX_BEND_PX, MAX_BEND = 1.0, 0.0012
"""Largest error of a place in the picture, likewise."""
MAX_FOCAL_DEVIATION = 0.02
"""Share of the focal length."""
FOCAL_FLOOR, CENTER_FLOOR_PX, DISTORTION_FLOOR = 0.002, 0.5, (2e-3, 2e-3, 1e-4, 1e-4)
"""No lens is known better: paper is not quite flat, and the lens is focused at another distance."""
OFF_CENTER = 0.06
"""Distance of the principal point from the picture's middle, as a share of the longer side, that a note names."""
GRID = 36
"""Places along each side of the picture at which its coverage is counted: a multiple of 3."""
ROWS, COLUMNS = ("upper", "", "lower"), ("left", "", "right")


def judged(
    names: Sequence[str],
    found: Sequence[BoardView | str],
    size_px: tuple[int, int],
    fitted: LensFit | None,
    reasons: tuple[Reason, ...],
) -> LensCalibration:
    """The verdict. found: the board in each picture, or why it does not count; fitted: None without a lens; reasons:
    why the pictures cannot serve at all."""
    seen = [one for one in found if isinstance(one, BoardView)]
    regions = _regions(seen, size_px)
    result = LensCalibration(
        lens=None if fitted is None else _settings(fitted, size_px),
        size_px=size_px,
        reasons=reasons,
        notes=(),
        pictures=tuple(_pictures(names, found, size_px, fitted)),
        corners=0 if fitted is None else sum(map(len, fitted.seen)),
        rms_px=float("nan") if fitted is None else fitted.rms_px,
        bend_error_px=float("nan") if fitted is None else fitted.bend_error_px(size_px),
        coverage=float(np.mean(list(regions.values()))),
        regions=regions,
        condition=float("inf") if fitted is None else fitted.condition,
    )
    if reasons:
        return result
    return replace(result, reasons=tuple(_refusals(result, fitted)), notes=tuple(_notes(result)))


def _settings(fitted: LensFit, size_px: tuple[int, int]) -> LensSettings:
    """The lens as [camera.lens] has it."""
    views = fitted.views
    deviations = np.sqrt(np.diag(fitted.covariance)[LENS])
    floor = [FOCAL_FLOOR * views.focal_px, CENTER_FLOOR_PX, CENTER_FLOOR_PX, *DISTORTION_FLOOR]
    focal, x, y, k1, k2, p1, p2 = np.maximum(deviations, floor).tolist()
    b1, b2, b3, b4, b5 = (round(float(k), 6) for k in views.distortion)
    return LensSettings(
        size_px=size_px,
        focal_px=round(views.focal_px, 3),
        center_px=(round(float(views.center_px[0]), 3), round(float(views.center_px[1]), 3)),
        distortion=(b1, b2, b3, b4, b5),
        focal_deviation_px=round(focal, 3),
        center_deviation_px=(round(x, 3), round(y, 3)),
        distortion_deviation=(round(k1, 6), round(k2, 6), round(p1, 6), round(p2, 6)),
    )


def _pictures(
    names: Sequence[str], found: Sequence[BoardView | str], size_px: tuple[int, int], fitted: LensFit | None
) -> Iterator[BoardPicture]:
    number = 0
    for name, one in zip(names, found, strict=True):
        if isinstance(one, str):
            yield BoardPicture(name, "", one, (), None, None, None)
            continue
        if fitted is None:
            corners = tuple((x, y, 0.0, 0.0) for x, y in one.pixels.round(2).tolist())
            yield BoardPicture(name, one.board.paper, "", corners, None, None, None)
            continue
        view, distances = fitted.seen[number], fitted.distances[number]
        tilt = float(np.degrees(np.arccos(min(abs(fitted.normals()[number, 2]), 1.0))))
        held_out = held_out_px(fitted.seen, size_px, number) if len(fitted.seen) > MIN_PICTURES else None
        corners = tuple((x, y, u, v) for x, y, u, v in np.column_stack([view.pixels, distances]).round(2).tolist())
        yield BoardPicture(name, one.board.paper, "", corners, rms(distances), held_out, tilt)
        number += 1


def _regions(seen: Sequence[BoardView], size_px: tuple[int, int]) -> dict[str, float]:
    """How much of each ninth of the picture boards have covered."""
    x, y = ((np.arange(GRID) + 0.5) / GRID * side for side in size_px)
    grid: Floats = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
    covered = np.zeros(len(grid), dtype=bool)
    for view in seen:
        covered |= inside_hull(grid, view.pixels)
    third = GRID // 3
    ninths = covered.reshape(3, third, 3, third).mean(axis=(1, 3))
    return {
        f"{row} {column}".strip() or "middle": float(ninths[i, j])
        for i, row in enumerate(ROWS)
        for j, column in enumerate(COLUMNS)
    }


def _refusals(result: LensCalibration, fitted: LensFit | None) -> Iterator[Reason]:
    """Everything that is wrong with a lens, the most telling first."""
    unseen = [f"{one.name} ({one.unseen})" for one in result.pictures if one.unseen]
    count, side = len(result.pictures), max(result.size_px)
    if count - len(unseen) < MIN_PICTURES:
        text = f"the board is seen in {count - len(unseen)} of {count} pictures, {MIN_PICTURES} are needed"
        text += f"; not in {', '.join(unseen)}" if unseen else ""
        yield Reason(text, "Hold the board near to the camera, wholly lit, still, in focus.")
        return
    if fitted is None:
        yield Reason("no lens sees the boards so", "Take the pictures anew, with a board that is flat.")
        return
    yield from _pose_refusals(result, fitted)
    if missing := [name for name, share in result.regions.items() if share < MIN_REGION]:
        verb = "was" if len(missing) == 1 else "were"
        text = f"the {_listed(missing)} of the picture {verb} never covered"
        yield Reason(text, "Hold the board there too, up to the picture's border and beyond it.")
    if result.rms_px > max(MAX_RMS_PX, MAX_RMS * side):
        text = f"the board's corners lie {result.rms_px:.1f} px (rms) beside where one lens can see them"
        yield Reason(
            text,
            "Lay the board flat, hold it still, and give whole pictures of one camera, neither scaled nor cropped.",
        )
    tested = [(one.held_out_px, one.name) for one in result.pictures if one.held_out_px is not None]
    if tested and max(tested)[0] > max(MAX_HELD_OUT_PX, MAX_HELD_OUT * side):
        text = f"the board in {max(tested)[1]} lies {max(tested)[0]:.1f} px beside where the lens of all others sees it"
        yield Reason(text, "Leave this picture out, or take it anew with a flat board.")
    deviation = fitted.covariance[0, 0] ** 0.5 / fitted.views.focal_px
    if result.bend_error_px > max(MAX_BEND_PX, MAX_BEND * side) or deviation > MAX_FOCAL_DEVIATION:
        text = f"places in the picture would be {result.bend_error_px:.1f} px off, the focal length {deviation:.1%}"
        yield Reason(text, "Take more pictures, with the board tilted to several sides.")


def _pose_refusals(result: LensCalibration, fitted: LensFit) -> Iterator[Reason]:
    """Boards that are all held the same way do not tell the focal length."""
    tilts = [one.tilt_deg for one in result.pictures if one.tilt_deg is not None]
    if max(tilts) < MIN_TILT_DEG:
        text = f"all boards are parallel to the picture, the most tilted one by {max(tilts):.0f} degrees"
        yield Reason(text, "Tilt the board by 20 to 40 degrees, to another side in every picture.")
        return
    alike = min(abs(float(one @ other)) for one, other in combinations(fitted.normals(), 2))
    if np.degrees(np.arccos(min(alike, 1.0))) < MIN_BETWEEN_DEG:
        text = "all boards are tilted to the same side"
        yield Reason(text, "Tilt the board by 20 to 40 degrees, to another side in every picture.")


def _notes(result: LensCalibration) -> Iterator[str]:
    unseen = [f"{one.name} ({one.unseen})" for one in result.pictures if one.unseen]
    if unseen:
        yield f"the board is not seen in {', '.join(unseen)}"
    if result.lens is not None:
        middle = (np.array(result.size_px) - 1.0) / 2.0
        off = float(np.hypot(*(np.array(result.lens.center_px) - middle)))
        if off > OFF_CENTER * max(result.size_px):
            yield f"the lens' center lies {off:.0f} px beside the middle of the picture: is the picture cropped?"


def _listed(words: Sequence[str]) -> str:
    """a; a and b; a, b and c."""
    return " and ".join(part for part in (", ".join(words[:-1]), words[-1]) if part)
