"""Pairs that contradict each other: not monotonic, or two readings of one distance of which either may be wrong."""

from collections.abc import Iterator

import numpy as np

from vision_core.calibration.mirror.fit import FocalPrior, MirrorFit, fit_mirror, jacobian
from vision_core.calibration.mirror.pairs import Pairs

APART_PX, APART_SIGMAS = 2.0, 5.7
"""Farther in than a nearer pair by so much, and by so many deviations of one pair (4 of a difference)."""
LEVERAGE = 0.3
"""A pair that determines its own place on the curve by at least this share may be wrong without anybody noticing."""
RIVAL_NOISE, RIVAL_NOISE_PX = 2.0, 0.5
"""Another choice of pairs is as good while its noise is at most so many times larger, or so small."""
SHOWN = 3


def contradictions(pairs: Pairs, noise_px: float) -> list[str]:
    """The worst contradictions among pairs, in words: with growing distance the radius must grow."""
    radii, distances = pairs.measured_px, pairs.distances_mm
    order = np.lexsort((-radii, distances))
    sorted_radii = radii[order]
    highest = np.maximum.accumulate(sorted_radii)
    behind = highest - sorted_radii
    found = []
    for place in np.argsort(-behind)[:SHOWN].tolist():
        if behind[place] <= max(APART_PX, APART_SIGMAS * noise_px):
            break
        farther = int(order[place])
        nearer = int(order[int(np.argmax(sorted_radii == highest[place]))])
        found.append(_words(pairs, nearer, farther))
    return found


def rivals(pairs: Pairs, prior: FocalPrior, fit: MirrorFit) -> Iterator[str]:
    """Pairs that count, but might be wrong in place of those that do not: the names of either."""
    if fit.kept.all():
        return
    design = jacobian(fit.logs, pairs.distances_mm)
    leverage = np.einsum("np,pq,nq->n", design, fit.noise_covariance, design) / fit.noise_px**2
    outliers = int((~fit.kept).sum())
    for number in np.flatnonzero(fit.kept & (leverage > LEVERAGE)).tolist():
        others = np.arange(len(pairs)) != number
        other = fit_mirror(pairs.chosen(others), prior)
        wrong = int((~other.kept).sum()) + 1
        is_quiet = other.noise_px <= max(RIVAL_NOISE * fit.noise_px, RIVAL_NOISE_PX)
        newly = others & ~fit.kept
        newly[others] &= other.kept
        if wrong <= outliers and is_quiet and newly.any():
            yield f"{pairs.names[number]} or {pairs.names[int(np.argmax(newly))]}"


def _words(pairs: Pairs, nearer: int, farther: int) -> str:
    (r_near, r_far), (mm_near, mm_far) = pairs.radii_px[[nearer, farther]], pairs.distances_mm[[nearer, farther]]
    if mm_near == mm_far:
        return f"{pairs.names[nearer]} and {pairs.names[farther]} say {r_near:g} and {r_far:g} px at {mm_far:g} mm"
    return (
        f"{pairs.names[nearer]} says {r_near:g} px at {mm_near:g} mm, but {pairs.names[farther]} only {r_far:g} px at"
        f" {mm_far:g} mm"
    )
