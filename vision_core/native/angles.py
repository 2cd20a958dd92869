"""Angles in compiled code: the twin of ``geometry.wrap_angle``, made from the same source."""

from vision_core import geometry
from vision_core.native.kernels import kernel

wrap_angle = kernel(geometry.wrap_angle)
