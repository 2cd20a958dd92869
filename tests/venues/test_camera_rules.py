"""A camera that cannot be is refused with what is wrong, in words; every shipped one is accepted (test_loader)."""

from pathlib import Path
from typing import Any

import msgspec
import pytest

from vision_core.errors import SettingsError
from vision_core.settings.schema import NamedPoint
from vision_core.venues.camera_rules import fit_residual
from vision_core.venues.loader import load_settings

CORNERS = {
    "left top": (-1.4, 1.15),
    "right top": (1.4, 1.15),
    "right bottom": (1.4, -1.15),
    "left bottom": (-1.4, -1.15),
}
SCALE_PX = 200.0


def pixel(x_m: float, y_m: float) -> tuple[float, float]:
    """Straight from above, 5 mm per pixel, the field's center in the middle of 640x480."""
    return 320.0 + SCALE_PX * x_m, 240.0 - SCALE_PX * y_m


def points(**changes: Any) -> list[dict[str, Any]]:
    """The four corners; changes: "pixel" and "field" functions for all, or values for one corner by its name."""
    on_pixel, on_field = changes.pop("pixel", lambda p: p), changes.pop("field", lambda p: p)
    made = [
        {"name": name, "pixel_px": on_pixel(pixel(*place)), "field_m": on_field(place)}
        for name, place in CORNERS.items()
    ]
    for point in made:
        point.update(changes.pop(point["name"].replace(" ", "_"), {}))
    assert not changes
    return made


def load(tmp_path: Path, made: list[dict[str, Any]], position_m: tuple[float, float, float] = (0.0, 0.0, 4.0)) -> None:
    text = ["[camera]", 'model = "homography"', "[camera.homography]", f"position_m = {list(position_m)}", "points = ["]
    text += [
        f'{{ name = "{p["name"]}", pixel_px = {list(p["pixel_px"])}, field_m = {list(p["field_m"])} }},' for p in made
    ]
    venue = tmp_path / "venue.toml"
    venue.write_text("\n".join([*text, "]"]))
    load_settings(str(venue))


def extra(name: str, x_m: float, y_m: float, off_px: float = 0.0) -> dict[str, Any]:
    x, y = pixel(x_m, y_m)
    return {"name": name, "pixel_px": (x, y + off_px), "field_m": (x_m, y_m)}


ALL = points()
CROSSED = points(left_top={"pixel_px": pixel(1.4, 1.15)}, right_top={"pixel_px": pixel(-1.4, 1.15)})
IMPOSSIBLE: dict[str, tuple[list[dict[str, Any]], str]] = {
    "two exchanged": (CROSSED, "lines cross: 'left top' and 'right top' seem to be exchanged"),
    "mirrored": (points(pixel=lambda p: (640.0 - p[0], p[1])), "a mirrored field: left and right, top and bottom"),
    "upside down": (points(pixel=lambda p: (p[0], 480.0 - p[1])), "a mirrored field: left and right, top and bottom"),
    "field x and y": (points(field=lambda p: (p[1], p[0])), "a mirrored field: x and y of field_m exchanged"),
    "pixel x and y": (points(pixel=lambda p: (p[1], p[0])), "a mirrored field: x and y of pixel_px exchanged"),
    "millimetres": (
        points(field=lambda p: (1e3 * p[0], 1e3 * p[1])),
        r"'left top' at \(-1400, 1150\) m: millimetres\?",
    ),
    "65 metres": (
        points(right_top={"field_m": (1.4, 65.0)}),
        r"'right top' at \(1.4, 65\) m; accepted: points on or near",
    ),
    "far outside": (points(right_top={"pixel_px": (12000.0, 30.0)}), r"'right top' at \(12000, 30\) px"),
    "same pixel": (points(right_top={"pixel_px": pixel(-1.4, 1.15)}), "'left top' and 'right top' coincide at pixel"),
    "same place": (points(right_top={"field_m": (-1.4, 1.15)}), r"coincide at \(-1.4, 1.15\) m"),
    "fifth again": ([*ALL, extra("again", -1.4, 1.15)], "'left top' and 'again' coincide"),
    "three on a line": (
        [*ALL[:3], extra("middle", 1.4, 0.0)],
        "'right top', 'right bottom', 'middle' lie on one line",
    ),
    "one point off": (
        [*ALL, extra("middle", 0.0, 0.0, off_px=50.0), extra("top", 0.0, 1.15)],
        "the fit of 6 points misses 'middle' by 3[0-9] px; accepted: .* within 6.4 px",
    ),
    "a patch of the field": (points(field=lambda p: (p[0] / 8.0, p[1] / 8.0)), "sees [0-9]% of the field"),
}


def test_right_points_are_accepted(tmp_path: Path) -> None:
    load(tmp_path, ALL)
    load(tmp_path, [*ALL, extra("middle", 0.0, 0.0, off_px=3.0), extra("top", 0.0, 1.15)])
    load(tmp_path, points(pixel=lambda p: (640.0 - p[0], 480.0 - p[1])))  # a camera that is turned by 180 degrees


@pytest.mark.parametrize(("made", "message"), IMPOSSIBLE.values(), ids=IMPOSSIBLE.keys())
def test_points_that_cannot_be_are_refused(tmp_path: Path, made: list[dict[str, Any]], message: str) -> None:
    with pytest.raises(SettingsError, match=message) as caught:
        load(tmp_path, made)
    assert "venue.toml, line" in caught.value.asked


@pytest.mark.parametrize(
    ("position_m", "message"),
    [
        ((0.0, 0.0, -4.0), "-4 m high; accepted: a camera higher than the robots' markers"),
        ((0.0, 0.0, 4000.0), "4000 m high; accepted: .* at most 100 m high"),
        ((50.0, 0.0, 4.0), r"48.6 m beside the field and 4 m high"),
    ],
)
def test_a_camera_at_an_impossible_place_is_refused(
    tmp_path: Path, position_m: tuple[float, float, float], message: str
) -> None:
    with pytest.raises(SettingsError, match=message):
        load(tmp_path, ALL, position_m)


@pytest.mark.parametrize(
    ("lens", "message"),
    [
        ("rotation_deg = [90.0, 0.0, 0.0]", "sees 0% of the field"),
        ("focal_px = 50000.0", "sees 0% of the field"),
        ("focal_px = 15.0", "robots that would be .* px wide"),
        ("distortion = [40.0, 0.0, 0.0, 0.0, 0.0]", "a distortion that folds the picture|sees [0-9]% of the field"),
        ("distortion = [-3.0, 0.0, 0.0, 0.0, 0.0]", "a distortion that folds the picture"),
    ],
)
def test_a_lens_that_cannot_see_the_field_is_refused(tmp_path: Path, lens: str, message: str) -> None:
    venue = tmp_path / "venue.toml"
    venue.write_text(f"[camera.pinhole]\n{lens}\n")
    with pytest.raises(SettingsError, match=message):
        load_settings(str(venue))


def test_the_residual_of_a_fit_names_the_point_that_is_off() -> None:
    made = [*ALL, extra("middle", 0.3, 0.2, off_px=20.0), extra("top", 0.0, 1.15), extra("bottom", -0.5, -1.15)]
    residual = fit_residual(msgspec.convert(made, tuple[NamedPoint, ...]))
    assert residual.worst == "middle"
    assert 5.0 < residual.worst_px < 20.0
    assert 0.0 < residual.rms_px < residual.worst_px
    exact = fit_residual(msgspec.convert(ALL, tuple[NamedPoint, ...]))
    assert exact.worst_px < 1e-6
