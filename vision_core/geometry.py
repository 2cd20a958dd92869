"""Plane geometry, and the types of arrays.

Field space: origin at the field's center, x along its length, y along its width, angles anticlockwise from x; metres
and radians.
"""

import math
from typing import Any, TypeAlias, TypeVar

import numpy as np
from numpy.typing import NDArray

Floats: TypeAlias = NDArray[np.float64]
Bytes: TypeAlias = NDArray[np.uint8]
Mask: TypeAlias = NDArray[np.bool_]
PixelPlaces: TypeAlias = NDArray[np.int32]
"""x, y, shape (n, 2)."""
Array = TypeVar("Array", bound=NDArray[Any])


def wrap_angle(angle_rad: float) -> float:
    """The same angle in [-pi, pi) [rad]. In kernels: ``native.angles.wrap_angle``."""
    return (angle_rad + math.pi) % (2.0 * math.pi) - math.pi


def rotation(angle_rad: float) -> Floats:
    """The matrix, shape (2, 2), that turns column vectors anticlockwise by an angle [rad]."""
    c, s = math.cos(angle_rad), math.sin(angle_rad)
    return np.array([[c, -s], [s, c]])


def frozen(array: Array) -> Array:
    """The same array, made read-only: the arrays of a record never change."""
    array.setflags(write=False)
    return array
