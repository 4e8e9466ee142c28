"""Exact rational numbers and arrays of them.

Arrays have dtype object. Elements are python-flint's ``fmpq`` where it is installed and ``fractions.Fraction``
otherwise: slower by an order of magnitude, with the same results.
"""

from collections.abc import Iterable
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

from robust_core.errors import ArgumentError

try:
    import flint

    _fmpq: Any = flint.fmpq
except ImportError:
    _fmpq = None

Exact = NDArray[np.object_]
Floats = NDArray[np.float64]


def rational(value: Any) -> Any:
    """One exact number from a float (its exact binary value), an int, a Fraction or a text such as "-10/7" or "0.6".

    >>> print(rational("0.6"), rational(0.25), rational("-10/7"))
    3/5 1/4 -10/7

    Raises
    ------
    ArgumentError: if it is not a finite number.
    """
    if _fmpq is not None and isinstance(value, _fmpq):
        return value
    try:
        if isinstance(value, float):
            numerator, denominator = value.as_integer_ratio()
        elif isinstance(value, int):
            numerator, denominator = value, 1
        else:
            fraction = Fraction(value if isinstance(value, str | Fraction) else float(value))
            numerator, denominator = fraction.numerator, fraction.denominator
    except (ValueError, OverflowError, TypeError, ZeroDivisionError) as error:
        raise ArgumentError("number", "finite and rational", repr(value)) from error
    return _fmpq(numerator, denominator) if _fmpq is not None else Fraction(numerator, denominator)


def exact_array(values: Any) -> Exact:
    """Array of exact numbers, of the shape of ``values`` (nested lists or an array)."""
    source = np.asarray(values)
    if source.dtype.kind == "U":
        source = source.astype(object)
    flat = source.ravel().tolist()
    out = np.empty(len(flat), dtype=object)
    for index, value in enumerate(flat):
        out[index] = rational(value)
    return out.reshape(source.shape)


def to_float(values: Exact) -> Floats:
    """Nearest floats; an exact number beyond their range raises ArgumentError."""
    try:
        flat = [_quotient(value) for value in values.ravel().tolist()]
    except OverflowError as error:
        raise ArgumentError("number", "within the range of floats", "a larger one") from error
    return np.array(flat, dtype=np.float64).reshape(values.shape)


def _quotient(value: Any) -> float:
    if type(value) is Fraction:
        return value.numerator / value.denominator
    return float(int(value.p) / int(value.q))


def to_text(values: Exact) -> list[str]:
    """Each number as "p/q" or "p", in C order; :func:`exact_array` reads them back."""
    return [str(value) for value in values.ravel().tolist()]


def all_zero(values: Iterable[Any]) -> bool:
    """Whether every number is exactly zero."""
    return all(value == 0 for value in values)


def definite(matrices: Exact, *, strict: bool = True) -> NDArray[np.bool_]:
    """Whether symmetric matrices (..., n, n) are positive definite (or semidefinite), decided exactly by LDL^T.

    >>> definite(exact_array([[2, 1], [1, 1]])), definite(exact_array([[1, 1], [1, 1]]), strict=False)
    (array(True), array(True))
    """
    work = matrices.copy()
    size = work.shape[-1]
    good = np.ones(work.shape[:-2], dtype=bool)
    one = rational(1)
    for step in range(size):
        pivot = work[..., step, step]
        positive = np.asarray(pivot > 0, dtype=bool)
        if strict:
            good &= positive
        else:
            # A semidefinite matrix with a zero on the diagonal has zeros in that row.
            rest = np.asarray(work[..., step, step + 1 :] == 0, dtype=bool).all(axis=-1)
            good &= positive | (np.asarray(pivot == 0, dtype=bool) & rest)
        if not good.any() or step == size - 1:
            break
        divisor = np.where(positive, pivot, one)[..., None, None]
        column = work[..., step + 1 :, step][..., :, None]
        row = work[..., step, step + 1 :][..., None, :]
        work[..., step + 1 :, step + 1 :] = work[..., step + 1 :, step + 1 :] - column * row / divisor
    return good


def solve_exact(matrix: Exact, right: Exact) -> Exact:
    """Solution x (n,) of a regular exact system by Gaussian elimination.

    Raises
    ------
    ArgumentError: if the matrix is singular.
    """
    size = len(right)
    work = np.concatenate([matrix, right[:, None]], axis=1)
    for step in range(size):
        pivot = next((row for row in range(step, size) if work[row, step] != 0), None)
        if pivot is None:
            raise ArgumentError("matrix", "regular", "a singular one")
        if pivot != step:
            work[[step, pivot]] = work[[pivot, step]]
        work[step, step:] = work[step, step:] / work[step, step]
        for row in range(size):
            if row != step and work[row, step] != 0:
                work[row, step:] = work[row, step:] - work[row, step] * work[step, step:]
    return work[:, size].copy()
