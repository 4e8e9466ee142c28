"""Angles on the circle."""

import math
from typing import overload

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@overload
def wrap_angle(angle_rad: float) -> float: ...
@overload
def wrap_angle(angle_rad: Array) -> Array: ...
def wrap_angle(angle_rad: float | Array) -> float | Array:
    """Wrap one angle or an array of them to (-pi, pi] (rad)."""
    if isinstance(angle_rad, np.ndarray):
        return math.pi - np.mod(math.pi - angle_rad, 2.0 * math.pi)
    return math.pi - (math.pi - angle_rad) % (2.0 * math.pi)


@overload
def angle_difference(target_rad: float, source_rad: float) -> float: ...
@overload
def angle_difference(target_rad: Array, source_rad: Array | float) -> Array: ...
def angle_difference(target_rad: float | Array, source_rad: float | Array) -> float | Array:
    """Shortest signed turn from ``source_rad`` to ``target_rad``, in (-pi, pi] (rad)."""
    return wrap_angle(target_rad - source_rad)
