"""Checks of arguments: finite numbers, right shapes, symmetry."""

from typing import Any

import numpy as np

from robust_core.errors import ArgumentError
from robust_core.rational import Floats


def finite_array(name: str, value: Any, shape: tuple[int | None, ...], remedy: str = "") -> Floats:
    """``value`` as floats of the given shape; None stands for any size of at least 1.

    Raises
    ------
    ArgumentError: for another shape, or entries that are not finite numbers.
    """
    wanted = f"an array ({', '.join('*' if size is None else str(size) for size in shape)}) of finite numbers"
    try:
        array = np.asarray(value, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise ArgumentError(name, wanted, f"{type(value).__name__} that is not one", remedy) from error
    fits = array.ndim == len(shape) and all(
        size > 0 if want is None else size == want for size, want in zip(array.shape, shape, strict=True)
    )
    if not fits:
        raise ArgumentError(name, wanted, f"shape {array.shape}", remedy)
    if not np.isfinite(array).all():
        where = tuple(int(k) for k in np.argwhere(~np.isfinite(array))[0])
        raise ArgumentError(name, wanted, f"{array[where]} at {where}", remedy)
    return array


def finite_number(
    name: str, value: Any, *, low: float = -np.inf, high: float = np.inf, open_low: bool = False
) -> float:
    """``value`` as a float within [low, high] (above ``low`` if ``open_low``)."""
    bracket = "(" if open_low else "["
    wanted = f"a finite number in {bracket}{low:g}, {high:g}]"
    try:
        number = float(value)
    except (TypeError, ValueError) as error:
        raise ArgumentError(name, wanted, repr(value)) from error
    if not np.isfinite(number) or number < low or number > high or (open_low and number == low):
        raise ArgumentError(name, wanted, repr(value))
    return number


def symmetric(name: str, value: Any, size: int | None = None, *, relative: float = 1e-12) -> Floats:
    """``value`` as a symmetric matrix; asymmetry beyond rounding is an error, not averaged away."""
    array = finite_array(name, value, (size, size))
    if array.shape[0] != array.shape[1]:
        raise ArgumentError(name, "a square matrix", f"shape {array.shape}")
    gap = np.abs(array - array.T)
    if gap.max() > relative * max(np.abs(array).max(), np.finfo(float).tiny):
        row, column = (int(k) for k in np.unravel_index(gap.argmax(), gap.shape))
        raise ArgumentError(
            name, "symmetric", f"{array[row, column]} at ({row}, {column}) and {array[column, row]} across"
        )
    return 0.5 * (array + array.T)
