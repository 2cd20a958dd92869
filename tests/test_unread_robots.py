"""Every robot-like thing that is not read has a reason with its place, also when its mates are read.

The table of faults: a small picture of each, with what is found and what is said first.
"""

import math
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import cv2
import numpy as np
import pytest

from tests.drawn_field import ROBOTS, drawn, points_venue, told
from tests.objects.drawing import CODES, STANDARD, Picture
from vision_core.geometry import Bytes
from vision_core.native.opencv import read_picture
from vision_core.patterns.loader import load_pattern
from vision_core.patterns.pattern import Pattern, mirrored

pytestmark = pytest.mark.slow

HEIGHT_M = STANDARD.robot.height_m
X, Y, HEADING = 0.1, 0.2, -2.2
"""Where yellow 4 stands."""
OTHERS = "b1 b2 b3 y1 y5"


@dataclass(frozen=True)
class Fault:
    """What is drawn, and what is said: regular expressions, the first reasons in their order."""

    picture: Callable[[], Bytes]
    robots: str
    said: tuple[str, ...]
    venue: str = field(default_factory=points_venue)


def without_yellow_4() -> Picture:
    return drawn(robots=[robot for robot in ROBOTS if robot[:2] != ("yellow", 4)])


def place() -> str:
    """Of yellow 4 in the picture, give or take a pixel."""
    x, y = drawn(robots=()).camera.pixel_from_field(np.array([[X, Y]]), HEIGHT_M)[0]
    near = [f"{round(value) + step}" for value in (x, y) for step in (-1, 0, 1)]
    return rf"\(({'|'.join(near[:3])}), ({'|'.join(near[3:])})\)"


def with_marker(code: str, middle: str = "yellow", middle_mm: float = 50.0) -> Callable[[], Bytes]:
    """Yellow 4 with other patches; "-" in the code leaves one away."""

    def picture() -> Bytes:
        shown = without_yellow_4()
        shown.paint_disc("body", X, Y, 0.09, HEIGHT_M)
        bare = STANDARD.patches[1:]
        shown.paint_pattern(
            Pattern(name="dots", robot=STANDARD.robot, patches=bare, code=STANDARD.code),
            "yellow", code, (X, Y, HEADING),
        )  # fmt: skip
        shown.paint_disc(middle, X, Y, middle_mm / 2000.0, HEIGHT_M)
        return shown.as_bytes()

    return picture


def all_with(change: Callable[[Bytes], Bytes]) -> Callable[[], Bytes]:
    return lambda: change(drawn().as_bytes())


def gray(pixels: Bytes) -> Bytes:
    return np.repeat(pixels.mean(axis=2).astype(np.uint8)[..., None], 3, axis=2)


def mosaic(pixels: Bytes) -> Bytes:
    raw = pixels[..., 1].copy()
    raw[::2, 1::2], raw[1::2, ::2] = pixels[::2, 1::2, 2], pixels[1::2, ::2, 0]
    return np.repeat(raw[..., None], 3, axis=2)


def twins() -> Bytes:
    shown = drawn()
    shown.paint_robot("blue", CODES[1], 0.3, -0.2, 1.0)
    return shown.as_bytes()


def two_overlap() -> Bytes:
    shown = drawn()
    shown.paint_robot("yellow", CODES[7], X + 0.11, Y, 0.4)
    return shown.as_bytes()


def far_off() -> Bytes:
    shown = drawn()
    shown.paint_robot("blue", CODES[9], 1.72, 0.6, 0.4)
    return shown.as_bytes()


FAULTS = {
    "nothing": Fault(lambda: drawn().as_bytes(), "b1 b2 b3 y1 y4 y5", ()),
    "a middle of 20 mm": Fault(
        with_marker(CODES[4], middle_mm=20.0),
        OTHERS,
        (rf"a yellow robot at {place()} px is not found: its middle patch is (19|2[012]) mm across, not 50 mm",),
    ),
    "a middle of 14 mm": Fault(
        with_marker(CODES[4], middle_mm=14.0),
        OTHERS,
        (rf"a yellow robot at {place()} px is not found: its middle patch is 1[45678] mm across",),
    ),
    "a middle of another color": Fault(
        with_marker(CODES[4], middle="orange"),
        OTHERS,
        (rf"a robot at {place()} px is not found: .* its middle patch is orange, not blue or yellow",),
    ),
    "a middle that no class has": Fault(
        with_marker(CODES[4], middle="purple"),
        OTHERS,
        (rf"a robot at {place()} px is not found: .* at its middle, .* which is neither blue nor yellow",),
    ),
    "a middle alone": Fault(
        with_marker("----"),
        OTHERS,
        (rf"a yellow robot at {place()} px is not found: its team's patch is there, without another patch",),
    ),
    "a patch missing": Fault(
        with_marker("P-GP"),
        f"{OTHERS} y?",
        (rf"the yellow robot at {place()} px has no id: 4 of the 5 .* the back left patch is missing",),
    ),
    "two robots with one marker": Fault(
        twins, "b2 b3 b? b? y1 y4 y5", ("two robots have the marker of blue 1, so none of them has an id: at ",)
    ),
    "a robot off the field": Fault(
        far_off,
        "b1 b2 b3 y1 y4 y5",
        (r"a blue robot at .* is not found: it lies off the field, at \(1.7\d, 0\.\d\d\) m",),
    ),
    "gray": Fault(all_with(gray), "", ("no color in this picture",)),
    "a raw mosaic": Fault(all_with(mosaic), "", ("this picture is a raw Bayer mosaic",)),
    "black": Fault(all_with(lambda pixels: pixels // 40), "", ("the picture is black",)),
}


@pytest.mark.parametrize("fault", FAULTS.values(), ids=FAULTS.keys())
def test_what_is_not_read_is_explained(fault: Fault, tmp_path: Path) -> None:
    found = told(tmp_path, fault.venue, fault.picture())
    assert found.robots == fault.robots
    assert bool(found.detect) == bool(fault.said)
    for words, reason in zip(fault.said, found.detect, strict=False):
        assert re.search(words, reason), found.detect


def test_twelve_bits_in_sixteen_are_read(tmp_path: Path) -> None:
    file = tmp_path / "deep.png"
    cv2.imwrite(str(file), drawn().as_bytes().astype(np.uint16) << 4)
    assert told(tmp_path, points_venue(), read_picture(file)).robots == "b1 b2 b3 y1 y4 y5"


def test_all_that_are_missed_are_listed(tmp_path: Path) -> None:
    """Twelve robots whose middles are too small: three are explained, and every place is said."""
    shown, places = drawn(robots=()), []
    for row in range(3):
        for column in range(4):
            x, y = -0.9 + 0.6 * column, -0.7 + 0.6 * row
            shown.paint_robot("blue", CODES[5], x, y, 0.4)
            shown.paint_disc("body", x, y, 0.026, HEIGHT_M)
            shown.paint_disc("blue", x, y, 0.009, HEIGHT_M)
            places.append(shown.camera.pixel_from_field(np.array([[x, y]]), HEIGHT_M)[0])
    found = told(tmp_path, points_venue(), shown.as_bytes())
    text = " ".join(found.detect)
    named = [(float(x), float(y)) for x, y in re.findall(r"\((\d+), (\d+)\)", text)]
    assert found.robots == ""
    assert found.detect[0].startswith("9 more blue robots are not found, at ")
    for x, y in places:
        assert any(math.hypot(x - u, y - v) < 3.0 for u, v in named), (x, y)


def test_markings_in_a_teams_color_are_one_reason(tmp_path: Path) -> None:
    """More yellow dots than the match has yellow robots."""
    shown = drawn(robots=[robot for robot in ROBOTS if robot[0] == "blue"])
    for number in range(8):
        shown.paint_disc("yellow", -1.0 + 0.28 * number, -1.0, 0.025, 0.0)
    found = told(tmp_path, points_venue(), shown.as_bytes())
    assert found.robots == "b1 b2 b3"
    assert len(found.detect) == 1
    assert found.detect[0].startswith("8 patches of a yellow robot's color and size are without another patch near, at")


def own_pattern(folder: Path, name: str, dots: Sequence[tuple[float, float]], ids: Sequence[str]) -> Pattern:
    """A pattern file of the team's dot in the middle and code dots of 40 mm round it."""
    patches = "\n".join(f'[[patches]]\ncolor = "code"\ncircle_mm = [{x}, {y}, 40.0]' for x, y in dots)
    codes = "\n".join(f'{number} = "{code}"' for number, code in enumerate(ids, start=1))
    file = folder / f"{name}.toml"
    file.write_text(
        f'name = "{name}"\n[robot]\noutline = "circle"\nradius_m = 0.09\nheight_m = 0.14\n'
        f'[[patches]]\ncolor = "team"\ncircle_mm = [0.0, 0.0, 50.0]\n{patches}\n'
        f'[code]\ncolors = ["green", "pink"]\n[code.ids]\n{codes}\n'
    )
    return load_pattern(str(file))


def test_headings_that_a_pattern_cannot_tell_are_called_ambiguous(tmp_path: Path) -> None:
    """Four dots nearly in a square: turned by half they lie a little beside each other's places."""
    dots = [(45.0, 43.0), (-50.0, 38.0), (-50.0, -38.0), (45.0, -43.0)]
    pattern = own_pattern(tmp_path, "square", dots, ("PPGG", "GGPP"))
    venue = points_venue() + '[robots]\npattern = "square.toml"\n#\n[match]\nnumbers = 2\n'
    shown = drawn(robots=())
    shown.paint_pattern(pattern, "blue", "PPGG", (X, Y, 0.5))
    found = told(tmp_path, venue, shown.as_bytes())
    assert "fit in two headings; accepted: 0.00" in found.validate
    words = r"the heading of 1 blue robot is ambiguous, at .*: turned, .* looks like itself .* = (0.00\d) or less"
    limit = re.search(words, found.detect[0])
    assert limit is not None, found.detect
    read = told(tmp_path, venue.replace("#", f"dot_tolerance_m = {limit[1]}"), shown.as_bytes())
    assert (read.robots, read.validate, read.detect) == ("b1", "", ())


@pytest.mark.parametrize(("ahead", "is_read"), [(8.0, False), (9.0, True)])
def test_a_heading_is_doubted_just_where_the_pattern_check_says_so(ahead: float, is_read: bool, tmp_path: Path) -> None:
    """Four dots nearly in a square: turned by a quarter they lie 7 or 8 mm beside each other's places."""
    a, b = 45.0 + ahead / 2.0, 45.0 - ahead / 2.0
    pattern = own_pattern(tmp_path, "square", [(b, a), (-a, b), (-a, -b), (b, -a)], ("PPGG", "GGPP"))
    shown = drawn(robots=())
    shown.paint_pattern(pattern, "blue", "PPGG", (X, Y, 0.5))
    found = told(
        tmp_path, points_venue() + '[robots]\npattern = "square.toml"\n[match]\nnumbers = 2\n', shown.as_bytes()
    )
    assert found.robots == ("b1" if is_read else "b?")
    assert ("fit in two headings" in found.validate) != is_read


def test_patches_that_run_together_are_named_with_what_to_do(tmp_path: Path) -> None:
    """Two code squares of one color, 3 mm apart where a pixel shows five."""
    square = "polygon_mm = [[{0}, {1}], [{2}, {1}], [{2}, {3}], [{0}, {3}], [{0}, {1}]]"
    boxes = [("team", (2, -70, 70, 70)), ("code", (-70, 2, -2, 70)), ("code", (-70, -70, -2, -1))]
    patches = "".join(f'[[patches]]\ncolor = "{color}"\n{square.format(*box)}\n' for color, box in boxes)
    file = tmp_path / "squares.toml"
    file.write_text(
        f'name = "squares"\n[robot]\noutline = "square"\nradius_m = 0.08\nheight_m = 0.14\n{patches}'
        '[code]\ncolors = ["green", "pink"]\nids = { 1 = "GP", 2 = "GG" }\n'
    )
    shown = drawn(robots=())
    for number, pose in ((1, (0.6, 0.4, 0.5)), (2, (X, Y, 0.5))):
        pattern = load_pattern(str(file))
        shown.paint_pattern(pattern, "blue", pattern.code_by_id[number], pose)
    venue = points_venue() + '[robots]\npattern = "squares.toml"\n[match]\nnumbers = 2\n'
    found = told(tmp_path, venue, shown.as_bytes())
    assert found.robots == "b1 b?"
    assert "patches 2 and 3 of squares id 2 have one color and are 3 mm apart" in found.validate
    assert re.search(
        r"patch seems? to have run together.*: a green blob at \(\d+, \d+\) px is as large as two, .* Give it an id "
        r"whose neighboring patches differ in color",
        found.detect[0],
    )


def test_markers_that_exist_only_mirrored_tell_a_mirrored_picture(tmp_path: Path) -> None:
    pattern = own_pattern(tmp_path, "one-handed", [(40.0, 50.0), (-60.0, 20.0), (-10.0, -60.0)], ("PPG", "GPG", "GGP"))
    venue = points_venue() + '[robots]\npattern = "one-handed.toml"\n[match]\nnumbers = 3\n'
    places = ((-0.6, 0.4), (0.5, 0.5), (-0.2, -0.5))
    as_they_are, in_mirror = drawn(robots=()), drawn(robots=())
    for number, (x, y) in enumerate(places, start=1):
        as_they_are.paint_pattern(pattern, "blue", pattern.code_by_id[number], (x, y, 0.7 * number))
        in_mirror.paint_pattern(mirrored(pattern), "blue", pattern.code_by_id[number], (x, y, 0.7 * number))
    right = told(tmp_path, venue, as_they_are.as_bytes())
    assert (right.robots, right.detect) == ("b1 b2 b3", ())
    wrong = told(tmp_path, venue, in_mirror.as_bytes())
    assert wrong.detect[0].startswith("this picture is a mirror image: 3 markers exist only mirrored"), wrong
    assert "this picture is a mirror image" in wrong.service[0]
