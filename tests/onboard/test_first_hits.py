"""What the compiled rays meet is what NumPy finds without candidates, from the mirror's points."""

import numpy as np
import pytest

from bench.onboard_numpy import first_hits
from vision_core.capture.synthetic.world import World
from vision_core.onboard.camera import OnboardCamera
from vision_core.onboard.ray_tracer import BALL, FLOOR, OUTSIDE, ROOM
from vision_core.types.objects import Team
from vision_core.venues.loader import load_settings


@pytest.mark.parametrize("venue", ["default", "demo-vsss", "open"])
def test_compiled_and_numpy_rays_meet_the_same(venue: str) -> None:
    options = {"field_preset": "ssl-division-b"} if venue == "open" else {}
    settings = load_settings("demo-vsss" if venue == "demo-vsss" else None, options=options)
    camera, world = OnboardCamera(settings, (Team.YELLOW, 2), size_px=(160, 120)), World(settings)
    seen: set[int] = set()
    for _ in range(6):
        world.advance(2.0)
        scene = camera.scene(world.snapshot())
        (labels, ranges), (expected, expected_ranges) = camera.labels(scene), first_hits(camera, scene)
        same = labels == expected
        assert same.mean() > 0.9999  # a ray may meet an edge
        np.testing.assert_allclose(ranges[same], expected_ranges[same], rtol=1e-9)
        seen |= {int(value) for value in np.unique(labels)}
    assert {FLOOR, ROOM, OUTSIDE} < seen
    assert max(seen) > 10
    assert BALL in seen or venue == "open"
