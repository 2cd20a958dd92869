"""The color table: every cell as its boxes say, the order of the classes, the index."""

import msgspec
import numpy as np
import pytest

from vision_core.color.lookup_table import cell_centers, compile_color_table, keep_classes
from vision_core.color.spaces import hsv_from_bgr, ymp_from_bgr
from vision_core.errors import SettingsError
from vision_core.settings.schema import ColorRange
from vision_core.venues.loader import load_settings

COLORS = load_settings().colors
RED_AND_SKY = msgspec.structs.replace(
    COLORS,
    space="hsv",
    classes={
        "red": (ColorRange(hue_deg=(350.0, 10.0), saturation=(0.5, 1.0)),),
        "warm": (ColorRange(hue_deg=(0.0, 60.0), saturation=(0.4, 1.0)),),
        "sky": (ColorRange(hue_deg=(200.0, 240.0)), ColorRange(value=(0.99, 1.0), saturation=(0.0, 0.02))),
    },
)


def test_index_is_bgr565() -> None:
    table = compile_color_table(RED_AND_SKY)
    rng = np.random.default_rng(1)
    colors = rng.integers(0, 256, (50, 40, 3), dtype=np.uint8)
    for bgr, found in zip(colors.reshape(-1, 3).tolist(), table.classes_of(colors).ravel(), strict=True):
        b, g, r = bgr
        assert found == table.classes[(b >> 3) * 2048 + (g >> 2) * 32 + (r >> 3)]


def test_cell_centers_lie_in_their_cells() -> None:
    centers = cell_centers().astype(np.intp)
    index = (centers[:, 0] >> 3) << 11 | (centers[:, 1] >> 2) << 5 | centers[:, 2] >> 3
    assert (index == np.arange(65536)).all()


def test_every_cell_is_what_its_boxes_say() -> None:
    table = compile_color_table(RED_AND_SKY)
    hue, saturation, value = hsv_from_bgr(cell_centers()).T
    red = ((hue >= 350) | (hue <= 10)) & (saturation >= 0.5)
    warm = (hue <= 60) & (saturation >= 0.4)
    sky = ((hue >= 200) & (hue <= 240)) | ((value >= 0.99) & (saturation <= 0.02))
    assert (table.classes == np.select([red, warm, sky], [1, 2, 3], 0)).all()
    assert table.names == ("", "red", "warm", "sky")
    assert table.index("sky") == 3
    assert ("red", "warm", int((red & warm).sum())) in table.disputed


def test_a_hue_of_the_ecimage_claims_no_greys() -> None:
    table = compile_color_table(
        msgspec.structs.replace(COLORS, space="ec", classes={"any": (ColorRange(hue_deg=(0.0, 360.0)),)})
    )
    module = ymp_from_bgr(cell_centers())[:, 1]
    assert ((table.classes == 1) == (module >= 6.0)).all()


def test_order_of_classes_decides_disputes() -> None:
    box = (ColorRange(luma=(100.0, 150.0)),)
    table = compile_color_table(msgspec.structs.replace(COLORS, space="ymp", classes={"first": box, "second": box}))
    luma = ymp_from_bgr(cell_centers())[:, 0]
    cells = int(((luma >= 100) & (luma <= 150)).sum())
    assert set(np.unique(table.classes).tolist()) == {0, 1}
    assert table.disputed == (("first", "second", cells),)


@pytest.mark.parametrize("bounds", [(350.0, 10.0), (-10.0, 10.0), (350.0, 370.0)])
def test_angles_wrap(bounds: tuple[float, float]) -> None:
    table = compile_color_table(
        msgspec.structs.replace(COLORS, space="hsv", classes={"red": (ColorRange(hue_deg=bounds),)})
    )
    hue = hsv_from_bgr(cell_centers())[:, 0]
    assert ((table.classes == 1) == ((hue >= 350) | (hue <= 10))).all()


def test_typical_color_is_of_its_class() -> None:
    table = compile_color_table(RED_AND_SKY)
    assert table.classes_of(table.mean_bgr[1:2])[0] == 1


def test_keep_classes_erases_the_others_only() -> None:
    table = compile_color_table(RED_AND_SKY)
    kept = keep_classes(table, {"warm"})
    assert kept.names == table.names
    assert (kept.classes == np.where(table.classes == 2, 2, 0)).all()


def test_tables_are_read_only() -> None:
    table = compile_color_table(RED_AND_SKY)
    with pytest.raises(ValueError, match="read-only"):
        table.classes[0] = 1


def test_more_classes_than_a_byte_can_number_are_refused() -> None:
    box = (ColorRange(value=(0.9, 1.0)),)
    many = msgspec.structs.replace(COLORS, classes={f"class{number}": box for number in range(256)}, samples={})
    with pytest.raises(SettingsError, match="256; accepted: at most 255"):
        compile_color_table(many)
