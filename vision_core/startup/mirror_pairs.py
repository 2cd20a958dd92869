"""Pairs of a mirror's calibration that a job names, and edges in on-board pictures."""

import math
from functools import reduce
from pathlib import Path

from vision_core.calibration.job import EdgeJob, MirrorJob, OnboardView
from vision_core.calibration.mirror.from_views import Surroundings, pairs_around
from vision_core.calibration.mirror.pairs import Pairs, pairs_of
from vision_core.calibration.mirror.target_edge import CLICK_PX, RadialEdge, edge_at_click, middle_of, strongest_edge
from vision_core.calibration.result import Progress
from vision_core.errors import SourceError
from vision_core.evaluation.surroundings import surroundings_in
from vision_core.native.opencv import read_picture
from vision_core.settings.schema import Settings


def pairs_for(job: MirrorJob, progress: Progress) -> Pairs:
    """The pairs of a job, typed ones and those of pictures.

    Raises SettingsError, SourceError and what progress raises.
    """
    rows, names = [(pair.r_px, pair.r_mm) for pair in job.pairs], [pair.name for pair in job.pairs]
    parts = [pairs_of(rows, names, job.rounding)] if rows or not job.views else []
    return reduce(Pairs.joined, [*parts, *(_of_view(view, job.settings, progress) for view in job.views)])


def _of_view(view: OnboardView, settings: Settings, progress: Progress) -> Pairs:
    progress(f"looking what stands around the robot of {view.picture.name}", 0.0)
    if view.text:
        around = Surroundings.from_text(view.text, f"what stands around the robot of {view.picture.name}")
    else:
        around = surroundings_in(Path(view.ceiling), settings, view.team, view.number)
    pixels = read_picture(Path(view.picture.path))
    return pairs_around(
        pixels, around, center_px=view.center_px, scale=view.scale, name=view.picture.name, progress=progress
    )


def find_edge(job: EdgeJob) -> RadialEdge:
    """The edge near a click, or the strongest one in a direction. Raises SourceError when there is none."""
    pixels = read_picture(Path(job.picture.path))
    center = job.center_px or middle_of(pixels)
    if job.place_px is not None:
        edge = edge_at_click(pixels, center, job.place_px)
    else:
        edge = strongest_edge(pixels, center, job.direction_rad, (0.0, math.hypot(*pixels.shape[:2])))
    if edge is None:
        accepted = f"a place within {CLICK_PX:g} px of an edge, on its ray from the center"
        raise SourceError(f"an edge in {job.picture.name}", found="none", accepted=accepted)
    return edge
