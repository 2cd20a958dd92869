"""Pairs of a mirror's calibration that a job names, and what is seen in on-board pictures."""

import math
from pathlib import Path

import numpy as np

from vision_core.calibration.job import EdgeJob, FoundPairs, MirrorJob, NamedPair, PairsJob, Rim, RimJob
from vision_core.calibration.mirror.from_views import Surroundings, pairs_around
from vision_core.calibration.mirror.pairs import Pairs, SharedError, pairs_of
from vision_core.calibration.mirror.target_edge import CLICK_PX, RadialEdge, edge_at_click, middle_of, strongest_edge
from vision_core.calibration.result import Progress
from vision_core.client.recognition.rim import find_rim
from vision_core.errors import SourceError
from vision_core.evaluation.surroundings import surroundings_in
from vision_core.native.opencv import read_picture


def pairs_for(job: MirrorJob) -> Pairs:
    """The pairs of a job. Raises SettingsError."""
    rows = [(pair.r_px, pair.r_mm) for pair in job.pairs]
    return pairs_of(rows, [pair.name for pair in job.pairs], job.rounding, [pair.shared for pair in job.pairs])


def find_pairs(job: PairsJob, progress: Progress) -> FoundPairs:
    """What stands around a robot in its picture. Raises SettingsError, SourceError and what progress raises."""
    progress(f"looking what stands around the robot of {job.picture.name}", 0.0)
    if job.text:
        around = Surroundings.from_text(job.text, f"what stands around the robot of {job.picture.name}")
    else:
        around = surroundings_in(Path(job.ceiling), job.settings, job.team, job.number)
    pixels, name = read_picture(Path(job.picture.path)), job.picture.name
    center = job.center_px or middle_of(pixels)
    found = pairs_around(pixels, around, center_px=center, scale=job.scale, name=name, progress=progress)
    pairs, angles = found.pairs, found.directions_rad
    away = np.stack([np.sin(angles), np.cos(angles)], axis=-1) * (pairs.radii_px * job.scale)[:, None]
    rows = zip(pairs.radii_px.tolist(), pairs.distances_mm.tolist(), pairs.names, pairs.shared.tolist(), strict=True)
    places = (np.array(center) - away).tolist()
    return FoundPairs(
        tuple(NamedPair(px, mm, called, SharedError(*shared)) for px, mm, called, shared in rows),
        tuple((x, y) for x, y in places),
    )


def find_mirror_rim(job: RimJob) -> Rim:
    """The mirror's rim in a picture. Raises SourceError when there is none."""
    try:
        rim = find_rim(read_picture(Path(job.picture.path)))
    except SourceError as error:
        accepted = "a round mirror before a dark outside, or its center typed"
        raise SourceError(f"the mirror's rim in {job.picture.name}", found=error.found, accepted=accepted) from None
    return Rim(rim.column, rim.row, rim.radius_px)


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
