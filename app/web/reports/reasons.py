"""Why something is refused, and figures that may not be known."""

import math
from collections.abc import Sequence

from app.web.reports.base import Report
from vision_core.types.reasons import Reason


class ReasonReport(Report):
    """Why a calibration is refused."""

    text: str
    advice: str


def reasons_from(reasons: Sequence[Reason]) -> list[ReasonReport]:
    """The reports of reasons."""
    return [ReasonReport(text=reason.text, advice=reason.advice) for reason in reasons]


def finite(value: float) -> float | None:
    """A figure; None: it is not known."""
    return value if math.isfinite(value) else None
