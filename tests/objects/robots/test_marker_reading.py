"""Markers read as a whole: ids without blobs, refusals of what is covered, overexposed or alike."""

import math

import numpy as np
import pytest

from tests.objects.drawing import PAINT_TABLE, Picture
from tests.objects.finding import empty_picture, finder_of, middle
from vision_core.color.lookup_table import cell_centers
from vision_core.color.references import references_of
from vision_core.geometry import Bytes
from vision_core.models.camera_kernels import camera_map_from
from vision_core.native.kernels import read_only
from vision_core.objects.observation import Observation
from vision_core.objects.robots.buffers import HYPOTHESIS, PATCH_COLUMNS
from vision_core.objects.robots.finder import find_robots
from vision_core.objects.robots.marker_reading import measure_patches, read_marker
from vision_core.objects.robots.markers import Marker
from vision_core.objects.robots.paint_residual import UNEVEN, X, Y
from vision_core.patterns.loader import load_pattern
from vision_core.types.colors import chromaticity
from vision_core.types.tables import MAX_ROBOTS, NO_ID, ROBOT, Table

SSL = load_pattern("ssl-standard")
FINDER = finder_of("ssl-standard")
FRONT_LEFT = np.array([0.035, 0.054772])


def robot_of(code: str, heading: float) -> tuple[Picture, np.ndarray]:
    """A blue robot in the middle of a picture, and where its front left dot is [m]."""
    drawn = empty_picture(SSL, 1.5, 44.0)
    x, y = middle(drawn, SSL.robot.height_m)
    drawn.paint_pattern(SSL, "blue", code, (x, y, heading))
    c, s = math.cos(heading), math.sin(heading)
    return drawn, np.array([x, y]) + np.array([[c, -s], [s, c]]) @ FRONT_LEFT


def found_without(drawn: Picture, place_m: np.ndarray, pixels: Bytes | None = None) -> Table:
    """What is found when the blob at a place is missing, as where the color table does not know a paint in shade."""
    blobs = drawn.blobs(table=PAINT_TABLE)
    at = drawn.camera.pixel_from_field(place_m, SSL.robot.height_m)[0]
    blobs = blobs[np.hypot(blobs["x_px"] - at[0], blobs["y_px"] - at[1]) > 4.0]
    pixels = drawn.as_bytes() if pixels is None else pixels
    seen = Observation(blobs, len(blobs), pixels, PAINT_TABLE.classes, camera_map_from(drawn.camera))
    out = np.zeros(MAX_ROBOTS, dtype=ROBOT)
    return out[: find_robots(seen, FINDER, 0, out)]


@pytest.mark.parametrize("marker", sorted(SSL.code_by_id))
def test_a_dot_without_a_blob_is_measured_at_its_place(marker: int) -> None:
    drawn, place = robot_of(SSL.code_by_id[marker], 0.3 + marker)
    (robot,) = found_without(drawn, place)
    assert robot["id"] == marker


@pytest.mark.parametrize("share", [0.4, 0.7])
def test_half_the_light_on_a_dot_changes_nothing(share: float) -> None:
    drawn, place = robot_of(SSL.code_by_id[5], 1.0)
    at = drawn.camera.pixel_from_field(place, SSL.robot.height_m)[0]
    y, x = np.mgrid[: drawn.height, : drawn.width]
    near = np.hypot(x - at[0], y - at[1]) < 6.0
    shaded = np.where(near[..., None], drawn.as_bytes() * share, drawn.as_bytes()).astype(np.uint8)
    (robot,) = found_without(drawn, place, read_only(shaded))
    assert robot["id"] == 5


def test_a_reflection_on_a_part_of_a_dot_leaves_its_color() -> None:
    drawn, place = robot_of(SSL.code_by_id[5], 1.0)
    at = drawn.camera.pixel_from_field(place, SSL.robot.height_m)[0]
    y, x = np.mgrid[: drawn.height, : drawn.width]
    lit = (np.hypot(x - at[0], y - at[1]) < 6.0) & (x < at[0])
    glaring = np.where(lit[..., None], 0.3 * drawn.as_bytes() + 170.0, drawn.as_bytes()).astype(np.uint8)
    plain, mixed = (measured(drawn, read_only(pixels)) for pixels in (drawn.as_bytes(), glaring))
    assert mixed[:, UNEVEN].max() > 2.0 * plain[:, UNEVEN].max()
    np.testing.assert_allclose(mixed[:, [X, Y]], plain[:, [X, Y]], atol=0.1)


def measured(drawn: Picture, pixels: Bytes) -> np.ndarray:
    """The patches of the robot that ``robot_of`` draws, in some pixels."""
    marker = FINDER.markers[0]
    robots, patches = np.zeros(1, dtype=ROBOT), np.zeros((1 + len(marker.slots_m), PATCH_COLUMNS))
    robots["x_m"], robots["y_m"] = middle(drawn, SSL.robot.height_m)
    robots["heading_rad"] = 1.0
    blobs = drawn.blobs(table=PAINT_TABLE)
    seen = Observation(blobs, len(blobs), pixels, PAINT_TABLE.classes, camera_map_from(drawn.camera))
    measure_patches(seen, marker, robots[0], patches)
    return patches


@pytest.mark.parametrize("cover", ["body", "yellow", "blue", "pale"])
def test_what_covers_a_dot_is_no_color_of_the_code(cover: str) -> None:
    for marker, code in SSL.code_by_id.items():
        drawn, place = robot_of(code, 0.7 * marker)
        drawn.paint_disc(cover, float(place[0]), float(place[1]), 0.022, SSL.robot.height_m)
        (robot,) = found_without(drawn, place)
        assert robot["id"] == NO_ID, (cover, marker)


def test_a_cable_over_a_dot_is_noticed() -> None:
    drawn, place = robot_of(SSL.code_by_id[9], 0.0)
    drawn.paint_polygon("body", place + np.array([[-0.03, 0.0], [0.03, 0.0], [0.03, 0.03], [-0.03, 0.03]]), 0.14)
    (robot,) = found_without(drawn, place)
    assert robot["id"] == NO_ID


def test_chromaticity_is_the_same_in_half_the_light_and_shifts_in_warmer_light() -> None:
    paints = np.array([[210.0, 100.0, 30.0], [90.0, 220.0, 80.0]]) * 10.0  # so bright that the dark level is nothing
    assert chromaticity(0.5 * paints) == pytest.approx(chromaticity(paints), abs=0.05)
    shifts = chromaticity(paints * np.array([0.7, 1.0, 1.2])) - chromaticity(paints)
    assert shifts[0] == pytest.approx(shifts[1], abs=0.05)


def test_a_class_without_colors_is_known_by_nothing() -> None:
    references = references_of(PAINT_TABLE.classes, cell_centers(), len(PAINT_TABLE.names) + 1)
    assert references.spreads[-1].tolist() == [4.0, 0.0, 4.0]


def patches_of(code: str, overexposed: int) -> np.ndarray:
    """Measured patches of a larc marker (three patches), one of them with blue and green saturated."""
    marker = finder_of("vsss-three-patch").markers[0]
    row = [*load_pattern("vsss-three-patch").code_by_id.values()].index(code)
    patches = np.zeros((9, PATCH_COLUMNS))
    for patch, color in enumerate(marker.worn[row]):
        patches[patch, :2] = marker.references.means[color]
    patches[overexposed, :3] = 0.0, -2.4, 3.0
    return patches


def read(marker: Marker, patches: np.ndarray, by_blobs: int) -> int:
    """The id that patches show where no other robot shows its paints."""
    number, certainty = read_marker(marker, np.zeros(1, HYPOTHESIS)[0], patches, np.zeros((256, 6)), by_blobs)
    assert 0.9 < certainty <= 1.0
    return number


@pytest.mark.parametrize(("code", "other"), [("RC", 2), ("RG", 2)])
def test_green_and_cyan_overexposed_are_not_told_apart(code: str, other: int) -> None:
    marker = finder_of("vsss-three-patch").markers[0]
    number = {value: key for key, value in load_pattern("vsss-three-patch").code_by_id.items()}[code]
    assert read(marker, patches_of(code, other), number) == NO_ID


def test_a_clipped_patch_is_not_read_where_the_blobs_say_nothing() -> None:
    marker, clear, clipped = finder_of("vsss-three-patch").markers[0], patches_of("MG", 0), patches_of("MG", 0)
    clear[0] = 0.0
    clear[0, :2] = clipped[0, :2] = marker.references.means[marker.anchor_class]
    clipped[0, 2] = 1.0
    assert read(marker, clear, NO_ID) == 11
    assert read(marker, clipped, NO_ID) == NO_ID
