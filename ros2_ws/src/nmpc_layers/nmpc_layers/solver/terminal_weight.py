"""Weight of the last pose error in axes of its own, which turn with the reference."""

import math
from dataclasses import dataclass
from typing import Any

import casadi
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Expression = Any

PACKED_COUNT = 6
_TRIANGLE = np.triu_indices(3)


@dataclass(frozen=True, slots=True)
class TerminalWeight:
    """Symmetric matrix that weighs the last pose error ahead of (m), left of (m) and in heading (rad) of the reference.

    packed: its upper triangle, row by row. Build it with `of`.
    """

    packed: tuple[float, float, float, float, float, float]

    @classmethod
    def of(cls, matrix: Any) -> "TerminalWeight":
        """The weight of a matrix (3, 3).

        Raises
        ------
        ValueError: if it is not finite, symmetric and positive semidefinite.
        """
        values = np.asarray(matrix, dtype=np.float64)
        if values.shape != (3, 3) or not np.isfinite(values).all():
            raise ValueError(f"a terminal weight must be a finite matrix (3, 3), got {matrix!r}")
        if not np.array_equal(values, values.T) or np.linalg.eigvalsh(values).min() < 0.0:
            raise ValueError(f"a terminal weight must be symmetric and positive semidefinite, got {values.tolist()}")
        return cls(tuple(values[_TRIANGLE].tolist()))

    @property
    def matrix(self) -> Array:
        """The matrix (3, 3)."""
        result = np.zeros((3, 3))
        result[_TRIANGLE] = self.packed
        return result + np.triu(result, 1).T

    def in_world(self, heading_rad: float) -> Array:
        """Upper triangle (6,) of the same weight for errors along x, along y and in heading.

        heading_rad: of the reference. One that is not finite gives no finite weight.
        """
        if not math.isfinite(heading_rad):
            return np.full(PACKED_COUNT, np.nan)
        along, cross, along_turn, across, across_turn, turn = self.packed
        c, s = math.cos(heading_rad), math.sin(heading_rad)
        return np.array(
            [
                c * c * along - 2.0 * c * s * cross + s * s * across,
                c * s * (along - across) + (c * c - s * s) * cross,
                c * along_turn - s * across_turn,
                s * s * along + 2.0 * c * s * cross + c * c * across,
                s * along_turn + c * across_turn,
                turn,
            ]
        )


def unpacked(packed: Expression) -> Expression:
    """The symmetric matrix (3, 3) of an upper triangle (6,), as CasADi expressions."""
    xx, xy, xt, yy, yt, tt = (packed[index] for index in range(PACKED_COUNT))
    rows = ((xx, xy, xt), (xy, yy, yt), (xt, yt, tt))
    return casadi.vertcat(*(casadi.horzcat(*row) for row in rows))


def weighed(packed: Expression, error: Expression) -> Expression:
    """Cost of a pose error (3,) under the weight with this upper triangle (6,)."""
    return casadi.dot(error, unpacked(packed) @ error)
