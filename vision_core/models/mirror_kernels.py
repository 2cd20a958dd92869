"""Equation 1 in compiled code: the twin of ``mirror.px_from_mm``, made from the same source."""

from vision_core.models import mirror
from vision_core.native.kernels import kernel

px_from_mm = kernel(mirror.px_from_mm)
