"""Plane geometry shared by all stages. Field space: origin at the field's center, x along its
length, y along its width, angles anticlockwise from x; metres and radians."""

import math
from typing import Any, TypeAlias, TypeVar

import numpy as np
from numpy.typing import NDArray

Floats: TypeAlias = NDArray[np.float64]
Bytes: TypeAlias = NDArray[np.uint8]
Mask: TypeAlias = NDArray[np.bool_]
Array = TypeVar("Array", bound=NDArray[Any])


def wrap_angle(angle_rad: float) -> float:
    """The same angle in [-pi, pi) [rad]."""
    return (angle_rad + math.pi) % (2.0 * math.pi) - math.pi


def rotation(angle_rad: float) -> Floats:
    """The 2x2 matrix that turns column vectors anticlockwise by an angle [rad]."""
    c, s = math.cos(angle_rad), math.sin(angle_rad)
    return np.array([[c, -s], [s, c]])


def frozen(array: Array) -> Array:
    """The same array, read-only: records hand out no array that can be changed."""
    array.setflags(write=False)
    return array
