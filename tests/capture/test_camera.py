"""What can be told of a device camera without one: whose instant counts, and how its absence is said."""

import pytest

from vision_core.capture.camera import driver_instant
from vision_core.capture.source import open_source
from vision_core.clock import NS_PER_MS, NS_PER_S, Instant, ManualClock
from vision_core.errors import SourceError
from vision_core.settings_files import load_settings

NOW = Instant(4000 * NS_PER_S)


def test_a_stamp_of_our_clock_is_believed() -> None:
    assert driver_instant(4_000_000.0 - 25.5, NOW) == NOW - 25_500_000


@pytest.mark.parametrize(
    "stamp_ms",
    [0.0, -1.0, 1.7e12, 4_000_000.0 - 1500.0, 4_000_000.0 + 20.0],
    ids=["none", "error", "wall clock", "too old", "future"],
)
def test_other_stamps_are_not(stamp_ms: float) -> None:
    assert driver_instant(stamp_ms, NOW) is None


def test_a_stamp_rounded_past_now_is_now() -> None:
    assert driver_instant(4_000_000.0 + 0.4, NOW) == NOW
    assert driver_instant((NOW - 3 * NS_PER_MS) / NS_PER_MS, NOW) == NOW - 3 * NS_PER_MS


def test_an_absent_camera_is_named() -> None:
    settings = load_settings(options={"source.uri": "camera:/dev/video-that-is-not-there"})
    with pytest.raises(SourceError, match="video-that-is-not-there") as caught:
        open_source(settings, ManualClock())
    assert caught.value.found
    assert caught.value.accepted
