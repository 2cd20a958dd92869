"""Where robots and balls are accepted: the kernel agrees with the field model, and with its tolerance."""

import math

import numpy as np
import pytest

from vision_core.models import field as field_model
from vision_core.objects.field_limits import accepted_extents, is_accepted
from vision_core.venues.loader import load_settings

FIELD = load_settings().field


def test_without_tolerance_it_is_the_field_model() -> None:
    extents = accepted_extents(FIELD)
    for x, y in np.random.default_rng(1).uniform(-2.5, 2.5, (500, 2)).tolist():
        assert is_accepted(x, y, 0.0, extents) == field_model.is_accepted(FIELD, x, y)


def test_tolerance_and_margin_move_the_limit_outward() -> None:
    _, y = field_model.accepted_half_extent(FIELD)
    assert not is_accepted(0.0, y + 0.05, 0.04, accepted_extents(FIELD))
    assert is_accepted(0.0, y + 0.05, 0.06, accepted_extents(FIELD))
    assert is_accepted(0.0, y + 0.05, 0.0, accepted_extents(FIELD, 0.06))


@pytest.mark.parametrize(("x", "y"), [(math.nan, 0.0), (0.0, math.nan)])
def test_no_place_is_not_accepted(x: float, y: float) -> None:
    assert not is_accepted(x, y, 0.1, accepted_extents(FIELD))
