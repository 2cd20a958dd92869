"""Markers by their shape alone: templates, the search, and names for the colors that are found."""

import math

import numpy as np
import pytest

from tests.objects.drawing import PAINTS, SETTINGS, Picture, overhead_camera
from vision_core.models.camera_kernels import camera_map_from
from vision_core.objects.robots.marker_shape import SIZES, fit_marker, fit_shape, scene_of
from vision_core.objects.robots.shape_search import find_candidates
from vision_core.objects.robots.template import disc_template, template_of
from vision_core.palette.naming import Group, name_paints
from vision_core.palette.trial import Kind
from vision_core.patterns.geometry import depth_mm
from vision_core.patterns.loader import load_pattern
from vision_core.patterns.pattern import TEAM, scaled
from vision_core.types.colors import chromaticity

EXTENT_M = 0.3, 0.3


NAMES = "ssl-standard", "vsss-three-patch", "t-plate", "mirosot-diagonal", "vsss-corner-patch"


@pytest.mark.parametrize("name", NAMES)
def test_every_region_s_points_lie_in_its_patch(name: str) -> None:
    pattern = load_pattern(name)
    template = template_of(pattern)
    ordered = sorted(pattern.patches, key=lambda patch: patch.color != TEAM)
    for patch, points in zip(ordered, template.points_m, strict=False):
        assert (depth_mm(patch, points * 1000.0) > 0.0).all()
    for region in template.points_m[template.patches :]:
        assert all((depth_mm(patch, region * 1000.0) < 0.0).all() for patch in ordered)


def drawn(pattern_name: str, code: str, heading: float) -> Picture:
    picture = Picture(overhead_camera(0.003, 220, 220), 220, 220)
    middle = picture.camera.field_from_pixel(np.array([[110.0, 110.0]]))[0]
    picture.paint_pattern(load_pattern(pattern_name), "blue", code, (float(middle[0]), float(middle[1]), heading))
    return picture


@pytest.mark.parametrize(
    ("name", "code"),
    [("ssl-standard", "PGPP"), ("vsss-three-patch", "RG"), ("t-plate", "")],
)
def test_a_marker_is_found_without_a_name_for_its_colors(name: str, code: str) -> None:
    picture, pattern = drawn(name, code, 0.7), load_pattern(name)
    pixels, camera = picture.as_bytes(), camera_map_from(picture.camera)
    floor = np.argwhere(np.ones((20, 20), dtype=np.bool_)).astype(np.int32) * 10
    template = template_of(pattern)
    found = find_candidates(pixels, scene_of(pixels, floor), camera, template, pattern.robot.height_m, EXTENT_M)
    assert found
    middle = picture.camera.field_from_pixel(np.array([[110.0, 110.0]]))[0]
    score, x, y, _, _ = found[0].poses[0]
    assert score > 0.6
    assert math.hypot(x - middle[0], y - middle[1]) < 0.012
    assert any(abs(math.remainder(pose[3] - 0.7, math.tau)) < 0.15 for pose in found[0].poses)


def test_a_fit_begins_with_more_than_one_size() -> None:
    pattern, x, y, heading = load_pattern("vsss-three-patch"), 0.004, -0.003, 0.75
    picture = Picture(overhead_camera(0.003, 220, 220), 220, 220)
    middle = picture.camera.field_from_pixel(np.array([[110.0, 110.0]]))[0]
    picture.paint_pattern(scaled(pattern, 0.9), "blue", "RG", (float(middle[0]), float(middle[1]), 0.7))
    pixels, camera = picture.as_bytes(), camera_map_from(picture.camera)
    scene = scene_of(pixels, np.argwhere(np.ones((20, 20), dtype=np.bool_)).astype(np.int32) * 10)
    template, height_m = template_of(pattern), pattern.robot.height_m
    pose = np.array([0.0, middle[0] + x, middle[1] + y, heading, 1.0])
    alone = [pose.copy(), pose.copy()]
    for size, one in zip(SIZES, alone, strict=True):
        one[4] = size
        fit_shape(scene, camera, template, height_m, 0.25 * template.smallest_m, one)
    fit_marker(scene, camera, template, height_m, 0.25 * template.smallest_m, pose)
    assert pose.tolist() == max(alone, key=lambda one: float(one[0])).tolist()
    assert pose[0] > 0.6


def test_names_follow_the_hues_in_another_light() -> None:
    paints = ("blue", "pink", "green")
    typical = np.array([PAINTS[name] for name in paints], dtype=np.float64)
    pattern = load_pattern("ssl-standard")
    picture, dimmed = drawn("ssl-standard", "PGPP", 0.7), np.array([0.55, 0.7, 0.8])
    pixels, camera = (picture.as_bytes() * dimmed).astype(np.uint8), camera_map_from(picture.camera)
    floor = np.argwhere(np.ones((20, 20), dtype=np.bool_)).astype(np.int32) * 10
    template = template_of(pattern)
    found = find_candidates(pixels, scene_of(pixels, floor), camera, template, pattern.robot.height_m, EXTENT_M)
    worn = np.array([[0, *(1 if letter == "P" else 2 for letter in code)] for code in pattern.code_by_id.values()])
    kind = Kind("blue", template, pattern.robot.height_m, tuple(pattern.code_by_id), worn)
    carpet = chromaticity(np.array([PAINTS["carpet"]]) * dimmed)
    naming = name_paints([Group(found, [kind])], chromaticity(typical), carpet)[0]
    assert [reading.id for reading in naming.readings if reading.margin > 3.0] == [0]


def test_a_ball_s_template_is_a_disc() -> None:
    template = disc_template(SETTINGS.ball.radius_m)
    assert template.patches == 1
    assert (np.hypot(*template.points_m[0].T) < SETTINGS.ball.radius_m).all()
    assert (np.hypot(*template.points_m[1].T) > SETTINGS.ball.radius_m).all()
