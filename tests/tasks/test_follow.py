"""The task follow tells the light in force, goes back to the set-up and forth again; others see with what it told."""

from collections.abc import Iterator

import msgspec
import numpy as np
import pytest

from tests.tasks.stage import Stage
from vision_core.clock import Instant
from vision_core.models.camera_setup import CameraSetup
from vision_core.pipeline.live_colors import LiveColors
from vision_core.pipeline.perception import Perception
from vision_core.rtdb import records
from vision_core.rtdb.infos import LiveSettings
from vision_core.scheduling.releases import IDLE, StepResult
from vision_core.tasks import follow
from vision_core.types.palette import LivePalette
from vision_core.venues.loader import load_settings

pytestmark = [pytest.mark.slow, pytest.mark.timeout(600)]  # the first test may compile the hot path

SETTINGS = load_settings()
CAMERA = CameraSetup.from_settings(SETTINGS)
CARPET = np.array(SETTINGS.colors.light.reference_bgr)


class Following(Stage):
    """The task follow, shown the carpet alone."""

    def __init__(self) -> None:
        super().__init__(follow, SETTINGS)
        self.live = records.LIVE_SETTINGS.writer(self.store)

    def see(self, share: float) -> StepResult:
        """A step with the carpet in a share of the light."""
        picture = np.zeros(CAMERA.shape, dtype=np.uint8)
        picture[:] = (CARPET * share).round()
        return self.show(picture)

    def adapt(self, wanted: bool) -> None:
        light = msgspec.structs.replace(SETTINGS.colors.light, adapt=wanted)
        colors = msgspec.structs.replace(SETTINGS.colors, light=light)
        told = LiveSettings.of(msgspec.structs.replace(SETTINGS, colors=colors))
        self.live.write(told, self.clock.now(), self.clock.now())

    def told(self) -> LivePalette:
        return records.palette("main").reader(self.store).value(self.clock.now())


@pytest.fixture
def stage() -> Iterator[Following]:
    made = Following()
    yield made
    made.close()


def test_a_light_that_has_settled_is_told_and_can_be_taken_back(stage: Following) -> None:
    assert (stage.told().light.gain_bgr, stage.told().changes, stage.told().held) == ((1.0, 1.0, 1.0), (), False)
    stage.see(1.0)
    stage.see(0.5)
    stage.see(0.5)
    assert stage.told().light.gain_bgr == (1.0, 1.0, 1.0)
    stage.see(0.5)
    half = stage.told().light
    assert half.gain_bgr == pytest.approx((2.0, 2.0, 2.0), rel=0.03)
    assert [(one.what, one.light) for one in stage.told().changes] == [("light", half)]
    stage.adapt(False)
    assert stage.see(0.5) == IDLE
    assert (stage.told().light.gain_bgr, stage.told().held) == ((1.0, 1.0, 1.0), True)
    stage.adapt(True)
    stage.see(0.5)
    assert (stage.told().light, stage.told().held) == (half, False)
    assert [one.what for one in stage.told().changes] == ["light", "held", "resumed"]
    stage.handle.switch()
    assert stage.told().light.gain_bgr == (1.0, 1.0, 1.0)


def test_perception_sees_in_the_light_that_is_told(stage: Following) -> None:
    perception = Perception(SETTINGS, CAMERA)
    colors = LiveColors(perception, records.palette("main").reader(stage.store))
    dim = np.zeros(CAMERA.shape, dtype=np.uint8)
    dim[:] = (CARPET * 0.5).round()
    colors.refresh(stage.clock.now())
    assert perception.lighting.lit(dim, Instant(1)) is dim  # it measures nothing by itself
    for _ in range(3):
        stage.see(0.5)
    colors.refresh(stage.clock.now())
    assert perception.lighting.lit(dim, Instant(2)).mean(axis=(0, 1)) == pytest.approx(CARPET, abs=2.0)
