"""What a venue's camera and tolerances make of a pattern that is in order by itself."""

import math
from collections.abc import Iterator
from itertools import combinations

import numpy as np

from vision_core.models.camera import CameraModel
from vision_core.models.field import accepted_half_extent
from vision_core.models.from_settings import robots_of
from vision_core.objects.robots.markers import largest_tolerance_m, marker_of, tells_heading
from vision_core.patterns.geometry import gap_mm
from vision_core.patterns.loader import load_pattern
from vision_core.patterns.pattern import Pattern, looks
from vision_core.settings.schema import Settings
from vision_core.types.colors import ColorTable
from vision_core.types.objects import Team
from vision_core.venues.violation import Violation

MIN_GAP_PX = 1.5
"""Patches of one color with a narrower gap run together: no pixel shows the ground between them alone."""
MAX_NAMED = 6
"""Ids that are listed."""


def pattern_warnings(settings: Settings, camera: CameraModel, table: ColorTable) -> Iterator[Violation]:
    """One per pattern and mistake. Raises SettingsError for a pattern that cannot be read, or lacks a color class."""
    done = set()
    for number, team in enumerate(Team):
        robots = robots_of(settings.robots, team)
        if robots.pattern in done:
            continue
        done.add(robots.pattern)
        pattern, tolerance_m = load_pattern(robots.pattern), settings.robots.dot_tolerance_m
        marker = marker_of(pattern, robots, team, number, table, tolerance_m)
        if not tells_heading(marker):
            found = f"{tolerance_m:g} m: so far off their places, the patches of {pattern.name} fit in two headings"
            enough_m = largest_tolerance_m(marker, tolerance_m)
            accepted = f"{enough_m:g} m or less" if enough_m else "a pattern that looks like itself in no other heading"
            yield Violation("robots.dot_tolerance_m", found, accepted)
        yield from _merging(pattern, mm_per_px(settings, camera, robots.height_m))


def mm_per_px(settings: Settings, camera: CameraModel, height_m: float) -> float:
    """How many millimetres a pixel shows at a height, where on the field that is most."""
    x, y = accepted_half_extent(settings.field)
    corners = np.array([(0.0, 0.0), (x, y), (x, -y), (-x, y), (-x, -y)])
    return 1e3 / math.sqrt(float(np.nanmin(camera.pixels_per_square_metre(corners, height_m))))


def _merging(pattern: Pattern, coarsest_mm: float) -> Iterator[Violation]:
    """Patches that run together where robots wear one color on both."""
    worn = list(looks(pattern))
    for i, j in combinations(range(len(pattern.patches)), 2):
        apart_mm = gap_mm(pattern.patches[i], pattern.patches[j])
        ids = sorted({number for _, number, colors in worn if colors[i] == colors[j]})
        if ids and apart_mm < MIN_GAP_PX * coarsest_mm:
            named = ", ".join(map(str, ids[:MAX_NAMED])) + (" ..." if len(ids) > MAX_NAMED else "")
            which = f"patches {i + 1} and {j + 1} of {pattern.name} {'id' if len(ids) == 1 else 'ids'} {named}"
            gap = f"{apart_mm:.2g} mm apart, {apart_mm / coarsest_mm:.1f} px at {coarsest_mm:.2g} mm per pixel"
            found = f"{which} have one color and are {gap}: they run into one, and such robots are not read"
            accepted = f"a gap of {MIN_GAP_PX * coarsest_mm:.2g} mm or more, or other ids"
            yield Violation("robots.pattern", found, accepted)
