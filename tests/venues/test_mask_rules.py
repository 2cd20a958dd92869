"""A mask that cannot be is refused with what was found and what is accepted."""

from typing import Any

import pytest

from vision_core.errors import SettingsError
from vision_core.venues.loader import load_settings

SQUARE = [[10.0, 10.0], [90.0, 10.0], [90.0, 60.0], [10.0, 60.0]]


def loaded(*masks: dict[str, Any]) -> Any:
    return load_settings(options={"camera.masks": list(masks)}).camera.masks


def test_masks_are_loaded() -> None:
    (mask,) = loaded({"name": "scoreboard", "points_px": SQUARE})
    assert (mask.name, mask.points_px[1]) == ("scoreboard", (90.0, 10.0))
    assert load_settings().camera.masks == ()


@pytest.mark.parametrize(
    ("masks", "found"),
    [
        ([{"name": "a", "points_px": SQUARE[:2]}], "length >= 3"),
        ([{"name": "a", "points_px": [*SQUARE] * 9}], "length <= 32"),
        ([{"name": "", "points_px": SQUARE}], "length >= 1"),
        ([{"name": str(number), "points_px": SQUARE} for number in range(17)], "length <= 16"),
        ([{"name": "a", "points_px": SQUARE}] * 2, "two masks of the name 'a'"),
        ([{"name": "a", "points_px": [*SQUARE, [700.0, 20.0]]}], r"\(700, 20\) px of mask 'a'.*0 to 640, 0 to 480"),
        ([{"name": "a", "points_px": [[1.0, 1.0], [5.0, 5.0], [9.0, 9.0]]}], "on one line"),
        ([{"name": "a", "points_px": [[float("nan"), 1.0], [5.0, 1.0], [9.0, 9.0]]}], "nan"),
    ],
)
def test_a_wrong_mask_is_refused(masks: list[dict[str, Any]], found: str) -> None:
    with pytest.raises(SettingsError, match=found):
        loaded(*masks)
