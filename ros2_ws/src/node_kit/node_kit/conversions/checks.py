"""Checks that every message family shares; each raises `RejectedMessage` with a short reason."""

import math
from collections.abc import Iterable, Sequence
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from node_kit.rejection import RejectedMessage

_QUATERNION_TOLERANCE = 0.01
_SYMMETRY_TOLERANCE = 1e-6
_PIVOT_TOLERANCE = 1e-9


def require_finite(name: str, value: float) -> float:
    """``value`` itself, if it is finite."""
    if not math.isfinite(value):
        raise RejectedMessage(f"not finite: {name}")
    return value


def require_all_finite(name: str, values: NDArray[np.floating]) -> None:
    """Refuse an array with a NaN or an infinity."""
    if not np.isfinite(values).all():
        raise RejectedMessage(f"not finite: {name}")


def require_not_negative(name: str, value: float) -> float:
    """``value`` itself, if it is finite and not negative."""
    if require_finite(name, value) < 0.0:
        raise RejectedMessage(f"negative: {name}")
    return value


def require_size(name: str, values: Sequence[object], size: int) -> None:
    """Refuse a sequence that does not have ``size`` elements."""
    if len(values) != size:
        raise RejectedMessage(f"size of {name} is {len(values)}, expected {size}")


def require_frame(name: str, frame_id: str) -> str:
    """``frame_id`` itself, if it names a frame."""
    if not frame_id:
        raise RejectedMessage(f"empty frame: {name}")
    if frame_id[0] == "/":
        raise RejectedMessage(f"frame starts with a slash: {name}")
    return frame_id


def require_unit_quaternion(name: str, x: float, y: float, z: float, w: float) -> tuple[float, float, float, float]:
    """The quaternion scaled to norm one, if its norm is within 1 % of it."""
    norm = math.sqrt(x * x + y * y + z * z + w * w) if max(map(abs, (x, y, z, w))) < 2.0 else math.inf
    if not abs(norm - 1.0) <= _QUATERNION_TOLERANCE:  # also true of NaN
        if all(map(math.isfinite, (x, y, z, w))):
            raise RejectedMessage(f"quaternion norm is not 1: {name}")
        raise RejectedMessage(f"not finite: {name}")
    return x / norm, y / norm, z / norm, w / norm


def checked_covariance(name: str, values: NDArray[np.float64], size: int) -> NDArray[np.float64]:
    """Row-major ``values`` as a read-only (size, size) matrix, if it is symmetric positive semi-definite.

    Sensors repeat the same covariance in every message, so checked ones are remembered.
    """
    return _covariance(name, values.tobytes(), size)


@lru_cache(maxsize=256)
def _covariance(name: str, content: bytes, size: int) -> NDArray[np.float64]:
    matrix = np.frombuffer(content)
    if matrix.size != size * size:
        raise RejectedMessage(f"size of {name} is {matrix.size}, expected {size * size}")
    matrix = matrix.reshape(size, size)
    problem = covariance_problem(matrix.tolist())
    if problem:
        raise RejectedMessage(f"{problem}: {name}")
    return matrix


def covariance_problem(matrix: list[list[float]]) -> str | None:
    """Why a square matrix is no covariance, or None.

    The test is a Cholesky factorisation of the correlations, so it does not depend on units, and it
    skips zeros, so planar covariances in 6x6 fields are cheap.
    """
    size = len(matrix)
    if not all(map(math.isfinite, _elements(matrix))):
        return "not finite"
    scales = []
    for index in range(size):
        variance = matrix[index][index]
        if variance < 0.0:
            return "negative variance"
        scales.append(math.sqrt(variance))
    correlations: list[dict[int, float]] = [{} for _ in range(size)]  # strict lower triangle by column
    for row in range(size):
        for column in range(row):
            lower, upper = matrix[row][column], matrix[column][row]
            if lower == 0.0 == upper:
                continue
            if scales[row] == 0.0 or scales[column] == 0.0:
                return "not positive semi-definite"
            correlation = lower / scales[row] / scales[column]
            if not abs(correlation - upper / scales[row] / scales[column]) <= _SYMMETRY_TOLERANCE:
                return "not symmetric"
            if not abs(correlation) <= 1.0 + _SYMMETRY_TOLERANCE:
                return "not positive semi-definite"
            correlations[column][row] = correlation
    return None if _has_cholesky(correlations) else "not positive semi-definite"


def _has_cholesky(columns: list[dict[int, float]]) -> bool:
    """Whether the unit-diagonal matrix with these strictly lower columns is positive semi-definite."""
    pivots = [1.0] * len(columns)
    for index, column in enumerate(columns):
        pivot = pivots[index]
        if pivot < -_SYMMETRY_TOLERANCE:
            return False
        if pivot <= _PIVOT_TOLERANCE:
            if any(abs(value) > 2e-3 for value in column.values()):
                return False
            continue
        rows = sorted(column)
        for place, row in enumerate(rows):
            factor = column[row] / pivot
            pivots[row] -= factor * column[row]
            for lower in rows[place + 1 :]:
                columns[row][lower] = columns[row].get(lower, 0.0) - factor * column[lower]
    return True


def _elements(matrix: list[list[float]]) -> Iterable[float]:
    return (value for row in matrix for value in row)
