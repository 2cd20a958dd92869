"""The field as the page draws it."""

import numpy as np
import pytest

from app.field_report import STEPS, Outlines, field_from
from vision_core.clock import Instant
from vision_core.rtdb.records import ServiceInfo
from vision_core.settings import Settings
from vision_core.settings_files import load_settings
from vision_core.settings_models import camera_model_from, mirror_from
from vision_core.types.objects import RobotSighting, Team


@pytest.fixture(scope="module")
def settings() -> Settings:
    return load_settings()


def test_mirror_table_inverts_the_mirror(settings: Settings) -> None:
    field = field_from(ServiceInfo("1", Instant(0), "", "", settings))
    mirror = mirror_from(settings)
    known = [(px, metres) for px, metres in enumerate(field.mirror_m) if metres is not None]
    assert len(field.mirror_m) == 255
    assert len(known) == int(mirror.horizon_px) + 1
    for px, metres in known[:-3]:  # at the horizon a pixel spans more than the rounding
        assert mirror.px_from_mm(metres * 1000.0) == pytest.approx(px, abs=0.05)


def test_painted_lines_lie_where_the_camera_sees_them(settings: Settings) -> None:
    field = field_from(ServiceInfo("1", Instant(0), "", "", settings))
    assert len(field.painted_px) == len(field.lines) + len(field.arcs)
    camera = camera_model_from(settings)
    for line, points in zip(field.lines, field.painted_px, strict=False):
        ends = camera.pixel_from_field(np.array([line[:2], line[2:]]))
        np.testing.assert_allclose([points[0], points[-1]], ends, atol=0.051)


def test_outlines_begin_at_the_heading(settings: Settings) -> None:
    camera = camera_model_from(settings)
    robots = []
    for x, y, heading in ((0.4, -0.3, 0.7), (-1.0, 0.8, None)):
        px, py = camera.pixel_from_field(np.array([[x, y]]), settings.robots.height_m)[0]
        robots.append(RobotSighting(Team.BLUE, 3, float(px), float(py), x, y, heading, 0.9, 0.001, 0.01))
    outlines = Outlines(settings).of(robots)
    assert [len(outline) for outline in outlines] == [STEPS, STEPS]
    nose = camera.field_from_pixel(np.array([outlines[0][0]]), settings.robots.height_m)[0] - (0.4, -0.3)
    assert np.hypot(*nose) == pytest.approx(settings.robots.radius_m, abs=1e-3)
    assert np.arctan2(nose[1], nose[0]) == pytest.approx(0.7, abs=0.01)


def test_no_robots_have_no_outlines(settings: Settings) -> None:
    assert Outlines(settings).of([]) == []
