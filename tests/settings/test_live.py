"""What is live is what the record of live settings holds, and nothing else."""

import msgspec
import pytest

from vision_core.rtdb.infos import LiveSettings
from vision_core.settings.live import LIVE, is_live
from vision_core.settings.schema import MirrorConstants, Settings
from vision_core.venues.loader import load_settings


@pytest.mark.parametrize(
    ("key", "live"),
    [
        ("match.blue_defends", True),
        ("mirror.blue", True),
        ("mirror.blue.a", True),
        ("tracks.validity_ms", True),
        ("views.r_min_m", True),
        ("admission.rules", True),
        ("tasks.obstacles.period_ms", True),
        ("tasks.obstacles.budget_ms", False),
        ("tasks.obstacles", False),
        ("tasks", False),
        ("matches.blue", False),
        ("server.port", False),
        ("field.length_m", False),
        ("colors.light.adapt", True),
        ("colors.light.dead_band", False),
        ("", False),
    ],
)
def test_live_keys(key: str, live: bool) -> None:
    assert is_live(key) is live


def test_the_record_has_every_live_section() -> None:
    beside = {"revision", "tasks", "ended", "adapt", "keys", "monitor_key", "fairness_asked", "games"}
    fields = set(LiveSettings.__slots__) - beside
    assert fields == set(LIVE) <= set(Settings.__struct_fields__)


def test_live_settings_change_the_live_part_alone() -> None:
    settings = load_settings()
    changed = msgspec.structs.replace(
        settings,
        mirror=msgspec.structs.replace(settings.mirror, yellow=MirrorConstants(a=4.0, b=0.0126, c=9e4)),
        match=msgspec.structs.replace(settings.match, blue_defends="right"),
    )
    live = msgspec.msgpack.decode(msgspec.msgpack.encode(LiveSettings.of(changed, 7)), type=LiveSettings)
    assert (live.revision, live.tasks, live.ended) == (7, {}, ())
    assert live.over(settings) == changed
    assert LiveSettings.of(settings).over(changed) == settings
