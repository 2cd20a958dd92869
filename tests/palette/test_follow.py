"""A palette that follows the light: on a rendered match whose light changes."""

import numpy as np
import pytest

from tests.palette.rendered import rendered, right_and_wrong
from vision_core.color.light import NEUTRAL_LIGHT
from vision_core.color.lookup_table import compile_color_table
from vision_core.evaluation.lights import LIGHTS
from vision_core.palette.follow import Follower
from vision_core.palette.reading import judged_again, palette_of_settings, table_of_settings
from vision_core.palette.recover import recovered
from vision_core.palette.trial import Trial
from vision_core.patterns.paints import PAINTS_BGR
from vision_core.settings.schema import Settings
from vision_core.venues.loader import load_settings

pytestmark = pytest.mark.timeout(600)  # the first test may compile the hot path


@pytest.fixture(scope="module")
def settings() -> Settings:
    return load_settings("demo-vsss")


def test_the_light_changes_and_the_palette_with_it(settings: Settings, monkeypatch: pytest.MonkeyPatch) -> None:
    shown = rendered(settings, PAINTS_BGR, monkeypatch, 5)
    follower = Follower(settings, compile_color_table(settings.colors))
    (first, truth), *others = shown
    look = follower.look(first)
    true, right, _ = right_and_wrong(look.palette.judged[0], truth)
    assert (look.what, right) == ("kept", true)
    seen = []
    for pixels, now in others:
        look = follower.look(LIGHTS["3500 K"](pixels))
        seen.append((look.what, right_and_wrong(look.palette.judged[0], now)))
    assert {"learned", "found"} & {what for what, _ in seen}
    assert all(wrong == 0 for _, (_, _, wrong) in seen)
    true, right, _ = seen[-1][1]
    assert right == true
    back = [follower.look(pixels) for pixels, _ in others]
    assert right_and_wrong(back[-1].palette.judged[0], others[-1][1])[1] == true


def test_the_palette_of_the_set_up_is_found_again_in_another_light(
    settings: Settings, monkeypatch: pytest.MonkeyPatch
) -> None:
    ((pixels, truth),) = rendered(settings, PAINTS_BGR, monkeypatch, 1)
    table = compile_color_table(settings.colors)
    trial = Trial(settings, settings.colors.light)
    picture = trial.prepared(LIGHTS["2700 K"](pixels), NEUTRAL_LIGHT)
    start = judged_again(trial, [picture], palette_of_settings(trial, table))
    true = len(truth.robots)
    assert start.read < true
    found = recovered(trial, picture, start, true)
    assert found is not None
    again = judged_again(trial, [picture], found)
    assert (again.read, right_and_wrong(again.judged[0], truth)[1:]) == (true, (true, 0))


def test_an_empty_field_changes_nothing(settings: Settings, monkeypatch: pytest.MonkeyPatch) -> None:
    ((pixels, _),) = rendered(settings, PAINTS_BGR, monkeypatch, 1)
    follower = Follower(settings, compile_color_table(settings.colors))
    follower.look(pixels)
    empty = np.full_like(pixels, 40)
    assert [follower.look(empty).what for _ in range(3)] == ["kept"] * 3


def test_a_palette_takes_the_places_of_the_settings_classes(settings: Settings) -> None:
    table = compile_color_table(settings.colors)
    follower = Follower(settings, table)
    own = palette_of_settings(follower.trial, table)
    assert own.table.names[1:] == follower.trial.paints
    for name in follower.trial.paints:
        assert np.array_equal(own.table.classes == own.table.index(name), table.classes == table.index(name))
    assert table_of_settings(own, table) is table
