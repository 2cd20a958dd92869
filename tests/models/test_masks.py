"""Polygons become pixels."""

import numpy as np

from vision_core.models.masks import masked_pixels
from vision_core.settings.schema import MaskSettings


def mask(*points: tuple[float, float]) -> MaskSettings:
    return MaskSettings(name="a", points_px=points)


def test_no_polygons_are_no_mask() -> None:
    assert masked_pixels((), (10, 10)) is None


def test_pixels_with_their_center_inside_are_masked() -> None:
    found = masked_pixels((mask((2.0, 3.0), (5.5, 3.0), (5.5, 6.0), (2.0, 6.0)),), (10, 8))
    assert found is not None
    expected = np.zeros((8, 10), dtype=np.bool_)
    expected[3:6, 2:6] = True
    assert (found == expected).all()


def test_a_polygon_may_be_hollow_and_several_add_up() -> None:
    horseshoe = mask((1, 1), (9, 1), (9, 9), (7, 9), (7, 3), (3, 3), (3, 9), (1, 9))
    found = masked_pixels((horseshoe, mask((4, 5), (6, 5), (5, 8))), (10, 10))
    assert found is not None
    assert found[2, 5]
    assert found[6, 2]
    assert found[6, 8]
    assert not found[4, 5]
    assert found[6, 5]
    assert not found[9, 5]


def test_a_polygon_at_the_edge_of_the_picture_ends_there() -> None:
    found = masked_pixels((mask((0, 0), (10, 0), (10, 8), (0, 8)),), (10, 8))
    assert found is not None
    assert found.all()
