"""A wrong calibration is never silent: what validate, detect, /readyz and the page say about each mistake.

The table of mistakes. What arithmetic shows is refused by ``pslv config validate``; what only the picture shows is said
by detect, and alike by /readyz and the page, with its direction and size.
"""

import re
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from app.cli import app
from tests.drawn_field import CORNERS_M, POSITION_M, camera, drawn, lens_venue, points_venue, told
from vision_core.geometry import Bytes, Floats
from vision_core.native.opencv import write_picture

pytestmark = pytest.mark.slow

PIXELS = camera().pixel_from_field(CORNERS_M)
BARREL, STRONG_BARREL = (-0.25, 0.05, 0.0, 0.0, 0.0), (-0.5, 0.2, 0.0, 0.0, 0.0)
ALL = "b1 b2 b3 y1 y4 y5"


@dataclass(frozen=True)
class Mistake:
    """A venue, the picture it is used with, and what is said: regular expressions; empty: nothing."""

    venue: str
    validate: str = ""
    is_refused: bool = False
    detect: str = ""
    service: str = ""
    picture: str = "field"
    robots: str = ALL


def refused(venue: str, words: str) -> Mistake:
    return Mistake(venue, words, True)


def shown(venue: str, words: str, picture: str = "field", robots: str = ALL) -> Mistake:
    """Said alike by detect and the service."""
    return Mistake(venue, detect=words, service=words, picture=picture, robots=robots)


def exchanged(first: int, second: int) -> Floats:
    pixels = PIXELS.copy()
    pixels[[first, second]] = PIXELS[[second, first]]
    return pixels


def moved(corner: int, by_px: tuple[float, float]) -> Floats:
    pixels = PIXELS.copy()
    pixels[corner] += by_px
    return pixels


def at_height(height_m: float) -> tuple[float, float, float]:
    return (*POSITION_M[:2], height_m)


def in_mirror(pixels: Floats) -> Floats:
    """Corners as they are clicked in the mirrored picture."""
    return (pixels * (-1.0, 1.0) + (639.0, 0.0))[[1, 0, 3, 2]]


FOUR_M = r"the markers of 6 robots are 11% smaller .*: a camera (3\.[89]|4\.[012]) m high, not 1\.00 m"
MIRRORED = "this picture is a mirror image: 4 of the 6 robots have ids that no robot of the match has"
MISTAKES = {
    "none": Mistake(points_venue()),
    "none, a lens": Mistake(lens_venue()),
    "crossed corners": refused(
        points_venue(exchanged(0, 1)), "lines cross: 'left top' and 'right top' seem to be exchanged"
    ),
    "mirrored points": refused(points_venue(PIXELS[[1, 0, 3, 2]]), "a mirrored field: left and right"),
    "transposed places": refused(points_venue(places=CORNERS_M[:, ::-1]), "a mirrored field: x and y of field_m exch"),
    "transposed pixels": refused(points_venue(PIXELS[:, ::-1]), "a mirrored field: x and y of pixel_px exchanged"),
    "millimetres": refused(points_venue(places=1e3 * CORNERS_M), "millimetres"),
    "camera in millimetres": refused(lens_venue((50.0, -50.0, 4000.0)), "4000 m high; accepted: .* at most 100 m"),
    "camera 4 km high": refused(points_venue(position_m=at_height(4000.0)), "4000 m high; accepted: .* at most 100 m"),
    "one point 15 px off": shown(
        points_venue(moved(0, (15.0, 0.0))),
        r"'left top' lies 1[456] px \([789] cm\) to the right of where the lines say: robots there are [789] cm off",
    ),
    "one point 15 px too high": shown(
        points_venue(moved(2, (0.0, -15.0))),
        r"'right bottom' lies 1[456] px \([789] cm\) above where the lines say: robots there are [789] cm off",
    ),
    "a lens 10 % too high": shown(
        lens_venue(at_height(4.4)), r"(10% larger in the picture|field (9|10)% too small).* a camera 4.0\d? m high"
    ),
    "a lens 10 % too low": shown(
        lens_venue(at_height(3.6)), r"(10% smaller in the picture|field 1[01]% too large).* a camera 4.0\d? m high"
    ),
    "a lens 10 % too high, no lines": shown(
        lens_venue(at_height(4.4)), "markers of 6 robots are 10% larger .* a camera 4.0 m high", "no lines"
    ),
    "1 m by tape in place of 4 m": shown(points_venue(position_m=at_height(1.0)), FOUR_M),
    "1 m by tape, no lines": shown(points_venue(position_m=at_height(1.0)), FOUR_M, "no lines"),
    "a camera 10 cm aside": shown(
        lens_venue((0.15, -0.05, 4.0)), r"the field (18|19) px \(10 cm\) too far left, .* placed 10 cm off"
    ),
    "a camera turned by 2 deg": shown(
        lens_venue(rotation_deg=(0.5, -0.6, 2.8)), r"the field turned clockwise by (1\.9|2\.[01]) deg"
    ),
    "a larger field's preset": shown(
        points_venue(preset="ssl-division-b"), "12 of 12 painted lines are where field_preset = 'ssl-2002' has them"
    ),
    "a smaller field's preset": shown(
        lens_venue(preset="mirosot-middle"), "12 of 12 painted lines are where field_preset = 'ssl-2002' has them"
    ),
    "ends of the field exchanged": Mistake(
        points_venue(PIXELS[[2, 3, 0, 1]]), "the left goal, at negative x, lies on the right of the picture"
    ),
    "names of opposite corners exchanged": Mistake(
        points_venue(names=("right bottom", "left bottom", "left top", "right top")),
        r"'right bottom' has field_m = \[-1.4, 1.15\], which is not bottom, nor is it in the picture",
    ),
    "points, camera 10 % too high: moves robots by 7 mm at most, as validate says": Mistake(
        points_venue(position_m=at_height(4.4))
    ),
    "a mirrored picture": shown(points_venue(in_mirror(PIXELS)), MIRRORED, "mirrored", "b5 b6 b7 y0 y3 y7"),
    "points in a barrel": shown(
        points_venue(camera(STRONG_BARREL, 800.0).pixel_from_field(CORNERS_M)),
        r"the lens bends lines, which named points cannot describe: up to 1[345] px \([789] cm\) between them",
        "strong barrel",
    ),
    "a lens in a barrel": Mistake(lens_venue(distortion=BARREL), picture="barrel"),
    "a lens in a strong barrel": Mistake(lens_venue(distortion=STRONG_BARREL, focal_px=800.0), picture="strong barrel"),
}


@pytest.mark.parametrize(("name", "status"), [("none", 0), ("one point 15 px off", 2)])
def test_validate_compares_a_picture(name: str, status: int, tmp_path: Path) -> None:
    venue, still = tmp_path / "venue.toml", tmp_path / "field.png"
    venue.write_text(MISTAKES[name].venue)
    write_picture(still, picture("field"))
    result = CliRunner().invoke(app, ["config", "validate", "--config", str(venue), "--picture", str(still)])
    assert result.exit_code == status, result.output
    assert "10% of its height of 4 m would move robots by up to 7 mm" in result.output
    assert re.search(MISTAKES[name].detect, result.output)


@cache
def picture(name: str) -> Bytes:
    if name == "mirrored":
        return np.ascontiguousarray(picture("field")[:, ::-1])
    lens = {"barrel": camera(BARREL), "strong barrel": camera(STRONG_BARREL, 800.0)}.get(name, camera())
    return drawn(lens, lines=name != "no lines").as_bytes()


@pytest.mark.parametrize("mistake", MISTAKES.values(), ids=MISTAKES.keys())
def test_a_wrong_calibration_is_never_silent(mistake: Mistake, tmp_path: Path) -> None:
    found = told(tmp_path, mistake.venue, picture(mistake.picture))
    assert re.search(mistake.validate or "^$", found.validate), found.validate
    assert found.is_refused == mistake.is_refused
    if mistake.is_refused:
        return
    assert found.robots == mistake.robots
    if not mistake.detect:
        assert (found.detect, found.service) == ((), ())
        return
    assert re.search(mistake.detect, found.detect[0]), found.detect
    assert len(found.service) == 1
    assert re.search(mistake.service, found.service[0]), found.service
