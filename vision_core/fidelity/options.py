"""Narrower and finer views (section 4.3): what the ceiling camera's own resolution makes of them.

A client may ask for a narrower field of view in finer steps, and for a mirror of more pixels: always 360 directions, so
that a message stays under 1400 bytes. No on-board picture is needed here: what is told of worlds that the ceiling
camera saw is compared with what would be told if their poses were known exactly.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import product

import numpy as np

from vision_core.fidelity.agreement import MAX_ERROR_PX, Agreement, compare
from vision_core.fidelity.ceiling import CeilingSide
from vision_core.fidelity.reports import Report
from vision_core.fidelity.worlds import CEILING_PX, FIELDS, ONBOARD_PX, Setup, random_world, zoomed
from vision_core.protocol.options import Options, ray_indices
from vision_core.views.renderer import MAX_RAYS

VIEWS = ((360.0, 1.0), (180.0, 0.5), (90.0, 0.25))
"""Field of view and resolution [deg], looking ahead."""
MOST_PX = 250.0
"""Horizon of the finer mirror, which is as large as two digits allow."""


@dataclass(frozen=True, slots=True)
class OptionRow:
    """One row of the table; shares are those of all directions."""

    field: str
    ceiling: str
    fov_deg: float
    resolution_deg: float
    horizon_px: float
    """Of the mirror."""
    worlds: int
    unserved: int
    """Worlds in which the ceiling camera did not find the viewer."""
    equal: float
    """Type and pixel are the same."""
    same_type: float
    """The type is the same here or in a neighboring direction."""
    within_px: float
    """And the distance within a pixel."""


def measure(
    seeds: Iterable[int], fields: Iterable[str] = tuple(FIELDS), ceilings: Iterable[str] = tuple(CEILING_PX)
) -> list[OptionRow]:
    """The table: a row per field, ceiling camera, mirror and view."""
    seeds = tuple(seeds)
    rows = []
    for field, ceiling in product(fields, tuple(ceilings)):
        setup = Setup(field, ceiling, ONBOARD_PX[field], tall=False)
        side = CeilingSide(setup, MAX_RAYS)
        snapshots = [random_world(side.settings, seed) for seed in seeds]
        worlds = [(side.world(snapshot), side.true_world(snapshot)) for snapshot in snapshots]
        zoom_most = MOST_PX / setup.mirror.horizon_px
        for zoom in (1.0, zoom_most) if zoom_most > 1.0 else (1.0,):
            mirror = zoomed(setup.mirror, zoom)
            pairs = [(side.report(seen, mirror), side.report(exact, mirror)) for seen, exact in worlds]
            rows += [_row(setup, view, mirror.horizon_px, pairs) for view in VIEWS]
    return rows


def _row(
    setup: Setup, view: tuple[float, float], horizon_px: float, pairs: list[tuple[Report | None, Report | None]]
) -> OptionRow:  # fmt: skip
    options = Options(version=2, fov_deg=view[0], center_deg=0.0, resolution_deg=view[1])
    served = [
        (part_of(told, options), part_of(exact, options))
        for told, exact in pairs
        if told is not None and exact is not None
    ]
    agreements = [compare(told, exact) for told, exact in served]
    equal = [(told.letters == exact.letters) & (told.px == exact.px) for told, exact in served]
    return OptionRow(
        field=setup.field,
        ceiling=setup.ceiling,
        fov_deg=view[0],
        resolution_deg=view[1],
        horizon_px=horizon_px,
        worlds=len(pairs),
        unserved=len(pairs) - len(served),
        equal=float(np.mean(equal)) if served else float("nan"),
        same_type=float(np.mean([each.same_type for each in agreements])) if served else float("nan"),
        within_px=_within(agreements),
    )


def _within(agreements: list[Agreement]) -> float:
    if not agreements:
        return float("nan")
    errors = np.concatenate([each.error_px[each.same_type] for each in agreements])
    return float((np.abs(errors) <= MAX_ERROR_PX).mean())


def part_of(report: Report, options: Options) -> Report:
    """The directions of a report that a client's options choose."""
    chosen = ray_indices(options, len(report.letters))
    if chosen is None:
        return report
    return Report(report.letters[chosen], report.radii_px[chosen], report.ball)
