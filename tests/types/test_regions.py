"""What is found of the field survives the database's packing, numbers that are none included."""

import math
from typing import Any

import msgspec
import pytest

from vision_core.clock import Instant
from vision_core.types.reasons import Reason
from vision_core.types.regions import ColorDrift, ExposureCheck, FieldBoundary, Finding, LineCheck

FOUND: list[tuple[Any, Any]] = [
    (Finding[FieldBoundary], FieldBoundary(((1.0, 2.5), (3.0, 4.0)), (0.5, 0.0), 0.9, -0.5, 0.75)),
    (Finding[FieldBoundary], FieldBoundary((), (), 0.0, None, None)),
    (Finding[LineCheck], LineCheck(12, 7, 0.75, 0.25, 0.0)),
    (Finding[LineCheck], LineCheck(0, 0, None, None, 1.0)),
    (Finding[LineCheck], LineCheck(12, 7, 0.75, 2.5, 0.0, (Reason("off", "Mend it.", 3.0, True),))),
    (Finding[ExposureCheck], ExposureCheck(230.0, 80.5, 0.01, (Reason("over-exposed", "Close the lens."),))),
    (Finding[ExposureCheck], ExposureCheck(None, None, None, ())),
    (Finding[ColorDrift], ColorDrift((0.5, 1.0, 2.0), "")),
]


@pytest.mark.parametrize(("kind", "found"), FOUND)
def test_findings_survive(kind: Any, found: Any) -> None:
    finding = Finding("main", 7, Instant(9), found)
    assert msgspec.msgpack.decode(msgspec.msgpack.encode(finding), type=kind) == finding


def test_rays_without_a_point_survive() -> None:
    boundary = FieldBoundary(((math.nan, math.nan),), (0.0,), 0.0, None, None)
    kept = msgspec.msgpack.decode(msgspec.msgpack.encode(boundary), type=FieldBoundary)
    assert math.isnan(kept.points_px[0][0])
