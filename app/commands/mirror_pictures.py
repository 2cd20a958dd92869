"""Pairs for ``pslv calibrate mirror`` from on-board pictures."""

import math
from dataclasses import dataclass
from functools import reduce
from pathlib import Path
from typing import TYPE_CHECKING

from app.commands.options import robot_of
from app.commands.progress import Progress
from vision_core.calibration.mirror.pairs import Pairs, pairs_of
from vision_core.calibration.mirror.rounding import Rounding
from vision_core.errors import SettingsError, SourceError

if TYPE_CHECKING:
    from vision_core.calibration.mirror.from_views import Surroundings
    from vision_core.geometry import Bytes
    from vision_core.settings.schema import Settings

Point = tuple[float, float]


@dataclass(frozen=True, slots=True)
class PictureOptions:
    """What the command line says of on-board pictures."""

    pictures: list[Path]
    at_mm: list[float]
    """Distance of the target in each picture."""
    clicks: list[str]
    """X,Y near the target's edge in each picture; none: the strongest edge in a direction."""
    direction_deg: float
    around: list[Path]
    """What stands around the robot in each picture: CSV files, or the ceiling camera's pictures of the same instant."""
    robot: str
    """Whose on-board pictures they are, for pictures of the ceiling camera."""
    center: str | None
    """X,Y of the mirror's image; None: the picture's middle."""
    scale: float
    """Pixels of the picture per pixel of equation 1."""


def pairs_from_pictures(options: PictureOptions, settings: "Settings") -> Pairs | None:
    """The pairs that the pictures show; None: there are no pictures. Raises SettingsError and SourceError."""
    count = len(options.pictures)
    _check_counts(options, count)
    if not count:
        return None
    if options.around:
        return reduce(Pairs.joined, _around(options, settings))
    clicks: list[Point | None] = [_point("--click", click) for click in options.clicks]
    rows = [
        (_target_px(path, click, options), distance)
        for path, click, distance in zip(options.pictures, clicks or [None] * count, options.at_mm, strict=True)
    ]
    return pairs_of(rows, [path.name for path in options.pictures], Rounding.EXACT)


def _check_counts(options: PictureOptions, count: int) -> None:
    given = {"--at": len(options.at_mm), "--around": len(options.around), "--click": len(options.clicks)}
    wanted = "one --at MM or one --around FILE for each --picture, and one --click X,Y for each or none"
    is_one_kind = (given["--at"], given["--around"]) in {(count, 0), (0, count)}
    if not is_one_kind or given["--click"] not in {0, count} or (options.around and options.clicks):
        found = ", ".join(f"{number} {name}" for name, number in {"--picture": count, **given}.items())
        raise SettingsError("the pictures", found=found, accepted=wanted)


def _target_px(path: Path, click: Point | None, options: PictureOptions) -> float:
    """Radius of the target's edge in a picture [px of equation 1]."""
    from vision_core.calibration.mirror.target_edge import direction_of, edge_at_click, strongest_edge
    from vision_core.native.opencv import read_picture

    pixels = read_picture(path)
    center = _center(options, pixels)
    if click is not None:
        edge, near = edge_at_click(pixels, center, click), f"{math.degrees(direction_of(center, click)):.0f} degrees"
    else:
        direction = math.radians(options.direction_deg)
        edge = strongest_edge(pixels, center, direction, (0.0, math.hypot(*pixels.shape[:2])))
        near = f"{options.direction_deg:g} degrees"
    if edge is None:
        accepted = "a target whose edge is seen, and a --click within 12 px of it"
        raise SourceError(f"the target in {path}", found=f"no edge at {near}", accepted=accepted)
    return edge.radius_px / options.scale


def _around(options: PictureOptions, settings: "Settings") -> list[Pairs]:
    from vision_core.calibration.mirror.from_views import pairs_around
    from vision_core.native.opencv import read_picture

    progress = Progress("calibrating")
    found = []
    try:
        for path, around in zip(options.pictures, options.around, strict=True):
            pixels, surroundings = read_picture(path), _surroundings(around, options, settings)
            found.append(
                pairs_around(
                    pixels,
                    surroundings,
                    center_px=_center(options, pixels),
                    scale=options.scale,
                    name=path.name,
                    progress=lambda what, share: progress.show(f"{share:.0%} {what}"),
                ).pairs
            )
    finally:
        progress.show("")
    return found


def _surroundings(path: Path, options: PictureOptions, settings: "Settings") -> "Surroundings":
    """Of a CSV file, or of a picture of the ceiling camera."""
    from vision_core.calibration.mirror.from_views import Surroundings
    from vision_core.evaluation.surroundings import surroundings_in

    if path.suffix.lower() in {".csv", ".txt", ".tsv"}:
        return Surroundings.read(path)
    return surroundings_in(path, settings, *robot_of(options.robot))


def _center(options: PictureOptions, pixels: "Bytes") -> Point:
    from vision_core.calibration.mirror.target_edge import middle_of

    return middle_of(pixels) if options.center is None else _point("--center", options.center)


def _point(option: str, text: str) -> Point:
    parts = text.split(",")
    try:
        x, y = (float(part) for part in parts)
    except ValueError:
        raise SettingsError(f"{option} {text}", found="no place", accepted="X,Y in pixels") from None
    return x, y
