"""Matrices as options of theorems: nested tuples of exact texts, so that certificates keep every digit."""

from typing import Any

import numpy as np

from robust_core.checks import finite_array
from robust_core.rational import Exact, exact_array, to_float, to_text

MatrixOption = tuple[Any, ...]


def matrix_option(name: str, value: Any, shape: tuple[int | None, ...]) -> MatrixOption:
    """Nested tuples of texts; floats keep their binary value.

    >>> matrix_option("K", [["0.1", 0.5]], (1, None))
    (('1/10', '1/2'),)

    Raises
    ------
    ArgumentError: for another shape, or entries that are not finite numbers.
    """
    source = np.asarray(value)
    exact = exact_array(finite_array(name, source, shape) if source.dtype.kind in "fiub" else source)
    finite_array(name, to_float(exact), shape)
    nested: Any = np.array(to_text(exact), dtype=object).reshape(exact.shape).tolist()
    option: MatrixOption = _tuples(nested)
    return option


def option_array(option: MatrixOption, *, exact: bool) -> Any:
    """The matrix that an option stands for, in one kind of numbers."""
    numbers: Exact = exact_array(option)
    return numbers if exact else to_float(numbers)


def rounded(values: Any, digits: int = 6) -> Any:
    """Floats as short decimals, for gains that people read: texts of ``digits`` significant digits, as an array."""
    flat = [f"{value:.{digits - 1}e}" for value in np.ravel(np.asarray(values, dtype=np.float64)).tolist()]
    return np.array(flat, dtype=object).reshape(np.shape(values))


def _tuples(value: Any) -> Any:
    return tuple(_tuples(item) for item in value) if isinstance(value, list) else value
