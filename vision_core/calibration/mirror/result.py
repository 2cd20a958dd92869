"""What pairs of radius and distance give: the mirror, how sure its curve is, and why it is not accepted."""

from dataclasses import dataclass

from vision_core.models.hyperboloid import Hyperboloid
from vision_core.models.mirror import Mirror
from vision_core.types.reasons import Reason


@dataclass(frozen=True, slots=True)
class PairResult:
    """One pair."""

    name: str
    """What messages call it: "line 7"."""
    r_px: float
    """Its radius as it was fitted: with half a pixel more than given where it was cut to a whole number."""
    r_mm: float
    off_px: float | None
    """How much farther from the center it lies than the curve; None: there is no curve."""
    counts: bool
    """Is it one that the curve was fitted to? The others contradict it."""


@dataclass(frozen=True, slots=True)
class CurvePoint:
    """The curve at one distance."""

    r_mm: float
    r_px: float
    deviation_px: float
    """Standard deviation of r_px."""


@dataclass(frozen=True, slots=True)
class MirrorCalibration:
    """A mirror that was fitted, or an attempt."""

    mirror: Mirror | None
    """None: too few pairs for any, or one that breaks a rule, which is among the reasons."""
    shape: Hyperboloid | None
    """Focal length, height and bend; None: too few pairs for any."""
    reasons: tuple[Reason, ...]
    """Why it is refused; empty: it is accepted."""
    notes: tuple[str, ...]
    """What one should know although it is accepted."""
    words: tuple[str, ...]
    """The verdict in sentences."""
    pairs: tuple[PairResult, ...]
    """In the order in which they were given."""
    curve: tuple[CurvePoint, ...] = ()
    """Over ``verdict.SPAN_MM``."""
    rms_px: float = float("nan")
    """Of the distances of the pairs that count from the curve."""
    median_px: float = float("nan")
    """The same without signs: half of the pairs lie nearer."""
    worst_px: float = float("nan")
    band_px: float = float("inf")
    """Two standard deviations of the curve, where they are largest between 0.1 and 2.5 m."""
    covariance: tuple[tuple[float, float, float], ...] = ()
    """Of A, B, C; 3 by 3."""
    condition: float = float("inf")
    """Condition number of the radii's derivatives by log h, log u and log f."""

    @property
    def accepted(self) -> bool:
        """May it be used?"""
        return not self.reasons
