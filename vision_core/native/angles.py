"""Angles in compiled code: ``geometry.wrap_angle`` for kernels, made from the same source."""

from vision_core import geometry
from vision_core.native.kernels import kernel

wrap_angle = kernel(geometry.wrap_angle)
