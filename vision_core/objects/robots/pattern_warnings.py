"""What a venue's camera and tolerances make of a pattern that is in order by itself."""

import math
from collections.abc import Iterator
from itertools import combinations

import numpy as np

from vision_core.models.camera import CameraModel
from vision_core.models.field import accepted_half_extent
from vision_core.models.from_settings import robots_of
from vision_core.objects.robots.markers import largest_tolerance_m, marker_of, tells_heading
from vision_core.objects.robots.shape_reading import MIN_MARGIN, margin_between
from vision_core.patterns.geometry import gap_mm
from vision_core.patterns.pattern import Patch, Pattern, looks
from vision_core.patterns.worn import worn_patterns
from vision_core.settings.schema import Settings, TeamRobotSettings
from vision_core.types.colors import ColorTable
from vision_core.types.objects import Team
from vision_core.venues.violation import Violation

MIN_GAP_PX = 1.5
"""Patches of one color with a narrower gap run together: no pixel shows the ground between them alone."""
ENOUGH = 1.6
"""A drawn margin between two shapes so many times the least one leaves room for pose, cut and noise."""
MAX_NAMED = 6
"""Ids that are listed."""


def pattern_warnings(settings: Settings, camera: CameraModel, table: ColorTable) -> Iterator[Violation]:
    """One per pattern and mistake. Raises SettingsError for a pattern that cannot be read, or lacks a color class."""
    done: list[Pattern] = []
    for team in Team:
        robots = robots_of(settings.robots, team)
        for number, pattern in enumerate(worn_patterns(settings.robots, team)):
            if pattern in done:
                continue
            if number and pattern.robot != done[-1].robot:
                found = f"{done[-1].name} and {pattern.name}, which are for bodies of different outline, size or height"
                accepted = "patterns for one body; that of the first one is taken for all"
                yield Violation("robots.pattern", found, accepted)
            done.append(pattern)
            coarsest_mm = mm_per_px(settings, camera, robots.height_m)
            yield from _warnings_of(pattern, robots, team, settings, table, coarsest_mm)


def _warnings_of(
    pattern: Pattern, robots: TeamRobotSettings, team: Team, settings: Settings, table: ColorTable, coarsest_mm: float
) -> Iterator[Violation]:  # fmt: skip
    """The mistakes of one pattern. coarsest_mm: what a pixel shows where that is most."""
    tolerance_m = settings.robots.dot_tolerance_m
    marker = marker_of(pattern, robots, team, 0, table, tolerance_m)
    if not tells_heading(marker):
        found = f"{tolerance_m:g} m: so far off their places, the patches of {pattern.name} fit in two headings"
        enough_m = largest_tolerance_m(marker, tolerance_m)
        accepted = f"{enough_m:g} m or less" if enough_m else "a pattern that looks like itself in no other heading"
        yield Violation("robots.dot_tolerance_m", found, accepted)
    yield from _merging(pattern, coarsest_mm)
    yield from _alike_shapes(pattern, coarsest_mm)


def mm_per_px(settings: Settings, camera: CameraModel, height_m: float) -> float:
    """How many millimetres a pixel shows at a height, where on the field that is most."""
    x, y = accepted_half_extent(settings.field)
    corners = np.array([(0.0, 0.0), (x, y), (x, -y), (-x, y), (-x, -y)])
    return 1e3 / math.sqrt(float(np.nanmin(camera.pixels_per_square_metre(corners, height_m))))


def _merging(pattern: Pattern, coarsest_mm: float) -> Iterator[Violation]:
    """Patches that run together where robots wear one color on both."""
    worn = [(number, colors, pattern.layout(number)) for _, number, colors in looks(pattern)]
    gaps: dict[tuple[Patch, Patch], float] = {}
    for i, j in combinations(range(len(pattern.patches)), 2):
        ids, least_mm = set(), math.inf
        for number, colors, layout in worn:
            pair = layout[i], layout[j]
            apart_mm = gaps[pair] if pair in gaps else gaps.setdefault(pair, gap_mm(*pair))
            if colors[i] == colors[j] and apart_mm < MIN_GAP_PX * coarsest_mm:
                ids.add(number)
                least_mm = min(least_mm, apart_mm)
        if ids:
            which = f"patches {i + 1} and {j + 1} of {pattern.name} {_named(ids)}"
            gap = f"{least_mm:.2g} mm apart, {least_mm / coarsest_mm:.1f} px at {coarsest_mm:.2g} mm per pixel"
            found = f"{which} have one color and are {gap}: they run into one, and such robots are not read"
            accepted = f"a gap of {MIN_GAP_PX * coarsest_mm:.2g} mm or more, or other ids"
            yield Violation("robots.pattern", found, accepted)


def _named(ids: set[int]) -> str:
    shown = sorted(ids)
    return f"{'id' if len(ids) == 1 else 'ids'} {', '.join(map(str, shown[:MAX_NAMED]))}" + (
        " ..." if len(ids) > MAX_NAMED else ""
    )


def _alike_shapes(pattern: Pattern, coarsest_mm: float) -> Iterator[Violation]:
    """Shapes of the code that a picture of the venue's resolution hardly tells apart."""
    shaped = next((patch for patch in pattern.patches if patch.shapes), None)
    if shaped is None:
        return
    for (i, one), (j, other) in combinations(enumerate(shaped.shapes), 2):
        margin = margin_between(one, other, coarsest_mm)
        if margin < ENOUGH * MIN_MARGIN:
            names = f"{pattern.code.shapes[i].name} and {pattern.code.shapes[j].name}"
            found = f"the shapes {names} of {pattern.name} differ by a margin of {margin:.0f}"
            yield Violation(
                "robots.pattern",
                f"{found} at {coarsest_mm:.2g} mm per pixel: such robots will often have no id",
                f"{ENOUGH * MIN_MARGIN:.0f} or more: larger shapes, or more different ones",
            )
