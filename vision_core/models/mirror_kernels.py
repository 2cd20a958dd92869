"""Equation 1 in compiled code: ``mirror.px_from_mm`` for kernels, made from the same source."""

from vision_core.models import mirror
from vision_core.native.kernels import kernel

px_from_mm = kernel(mirror.px_from_mm)
