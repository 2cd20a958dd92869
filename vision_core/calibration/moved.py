"""Did the camera move between the pictures it is calibrated by? Each picture's own pose says so."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from vision_core.calibration.align import look, posed, searched, shifted
from vision_core.calibration.find import corners_m
from vision_core.calibration.judge import Scene
from vision_core.calibration.lens import Lens
from vision_core.calibration.painted import sections_for
from vision_core.calibration.profiles import FloatImage
from vision_core.calibration.result import PictureResult
from vision_core.calibration.ridges import find_ridges
from vision_core.calibration.solver import Sights
from vision_core.geometry import Bytes, Floats
from vision_core.types.reasons import Reason

NEAR_PX = 3.0
"""A section counts as seen in a picture when its paint lies so near to its place."""
FEW = 0.3
"""A picture that shows less than this share of what the best one shows is aligned anew, from farther away."""
MIN_SIGHTS = 20
NOTED_PX, NOTED = 1.0, 0.0012
"""A picture in which the field lies farther away is named: in pixels, or as a share of the picture's longer side."""
MOVED_PX, MOVED = 3.0, 0.004
"""The same for a refusal."""


@dataclass(frozen=True, slots=True, eq=False)
class _Own:
    """A picture with a pose of its own."""

    lens: Lens
    sights: Sights


def pictures_seen(
    scene: Scene, lens: Lens, pictures: Sequence[Bytes], lumas: Sequence[FloatImage], names: Sequence[str]
) -> tuple[PictureResult, ...]:
    """What each picture shows of the field, and how far from where the others show it.

    lens: of all pictures together; pictures, lumas: the same, shape (height, width, 3) and (height, width).
    """
    own = [_own(scene, lens, None, luma) for luma in lumas]
    most = max(len(one.sights) for one in own)
    for number, (pixels, luma) in enumerate(zip(pictures, lumas, strict=True)):
        if len(own[number].sights) < FEW * most:
            other = _own(scene, lens, pixels, luma)
            own[number] = max(own[number], other, key=lambda one: len(one.sights))
    usable = [one for one in own if len(one.sights) >= MIN_SIGHTS]
    middle = _middle(usable, corners_m(scene.field)) if len(usable) > 1 else None
    return tuple(_result(name, one, middle) for name, one in zip(names, own, strict=True))


def moved_reasons(results: Sequence[PictureResult], size_px: tuple[int, int]) -> tuple[Reason, ...]:
    """The pictures that show the field elsewhere than the others do; () when none does."""
    moved = list(_beside(results, max(MOVED_PX, MOVED * max(size_px))))
    advice = "Did the camera move, or is it another one? Leave that picture out." if len(results) > 2 else (
        "Did the camera move, or is it another one? Take new pictures, or use one of them."
    )  # fmt: skip
    return (Reason("; ".join(moved), advice),) if moved else ()


def moved_notes(results: Sequence[PictureResult], size_px: tuple[int, int]) -> Iterator[str]:
    """The same for small distances, and the pictures that show hardly any lines."""
    if not moved_reasons(results, size_px):
        yield from _beside(results, max(NOTED_PX, NOTED * max(size_px)))
    few = [one.name for one in results if one.shift_px is None]
    if few and len(results) > 1:
        yield f"hardly any lines are seen in {', '.join(few)}"


def _beside(results: Sequence[PictureResult], limit_px: float) -> Iterator[str]:
    """In words, the pictures that show the field farther away from the others than a limit."""
    for one in results:
        if one.shift_px is not None and one.apart_px > limit_px:
            yield f"{one.name} shows the field {one.apart_px:.1f} px {_direction(one)} where the others show it"


def _direction(one: PictureResult) -> str:
    """To which side a picture shows the field."""
    assert one.shift_px is not None
    x, y = one.shift_px
    if np.hypot(x, y) < one.apart_px / 2.0:
        return "turned away from"
    if abs(x) > abs(y):
        return "to the right of" if x > 0.0 else "to the left of"
    return "below" if y > 0.0 else "above"


def _own(scene: Scene, lens: Lens, pixels: Bytes | None, luma: FloatImage) -> _Own:
    """One picture's pose, with the lens of all; pixels: given, it is searched from far away."""
    prior = posed(scene.prior, lens)
    painted = sections_for(scene.field, lens)
    begin = shifted(lens, painted, find_ridges(pixels), prior) if pixels is not None else lens
    found = searched(begin, painted, [luma], prior, wide=pixels is not None)
    moved = found.lens if found is not None else lens
    return _Own(moved, look(painted, moved, [luma], NEAR_PX, singles=False).sights)


def _middle(own: Sequence[_Own], corners: Floats) -> Lens:
    """The pose that is nearest to all others."""
    seen = np.array([one.lens.project(corners) for one in own])
    apart = np.hypot(*np.moveaxis(seen[:, None] - seen, -1, 0)).mean(axis=-1)
    return own[int(np.median(apart, axis=1).argmin())].lens


def _result(name: str, one: _Own, middle: Lens | None) -> PictureResult:
    if len(one.sights) < MIN_SIGHTS:
        return PictureResult(name, len(one.sights), None, float("nan"))
    if middle is None:
        return PictureResult(name, len(one.sights), (0.0, 0.0), 0.0)
    places = one.sights.places_m(one.lens)
    moves = one.lens.project(places) - middle.project(places)
    x, y = np.median(moves, axis=0).round(2).tolist()
    return PictureResult(name, len(one.sights), (x, y), float(np.sqrt((moves**2).sum(axis=1).mean())))
