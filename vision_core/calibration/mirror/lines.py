"""A and B of a mirror of given focal length: R / r = A - B sqrt(f^2 + R^2) is a line, and two pairs determine it.

Of many lines through two pairs the one counts that most pairs lie near to: half of them may be wrong.
"""

import numpy as np

from vision_core.geometry import Floats
from vision_core.models.mirror import px_from_mm

TRIED = 300
"""Lines through two pairs; all of them where there are not more."""


def mirrors_through(radii_px: Floats, distances_mm: Floats, focal_px: float) -> tuple[Floats, Floats]:
    """A and B of mirrors through two pairs each, both of shape (k, 2): shape (m,), those that are mirrors."""
    roots, ratios = np.hypot(focal_px, radii_px), radii_px / distances_mm
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        b = (ratios[:, 0] - ratios[:, 1]) / (roots[:, 1] - roots[:, 0])
        a = ratios[:, 0] + b * roots[:, 0]
        is_mirror = np.isfinite(a) & (b > 0.0) & (a > b * focal_px)
    return a[is_mirror], b[is_mirror]


def radii_through(a: Floats, b: Floats, focal_px: float, distances_mm: Floats) -> Floats:
    """R [px] of distances on the floor, shape (n,), by mirrors, shape (m,): shape (m, n)."""
    c, (a, b) = focal_px**2, (a[:, None], b[:, None])
    return np.asarray(px_from_mm(distances_mm, a, b, c, a * a - b * b * c))


def best_line(radii_px: Floats, distances_mm: Floats, focal_px: float) -> tuple[float, float] | None:
    """A and B of the line from which half of the pairs are nearest [px]; None: no two pairs are a mirror."""
    two = np.stack(np.triu_indices(len(radii_px), 1), axis=-1)
    if len(two) > TRIED:
        two = two[np.random.default_rng(len(radii_px)).choice(len(two), TRIED, replace=False)]
    a, b = mirrors_through(radii_px[two], distances_mm[two], focal_px)
    if not len(a):
        return None
    off = np.abs(radii_through(a, b, focal_px, distances_mm) - radii_px)
    best = int(np.argmin(np.median(off, axis=1)))
    return float(a[best]), float(b[best])
