"""From stacks of symmetric matrices to the rows of a conic solver, and back for the multipliers.

1 x 1 matrices become non-negative numbers, 2 x 2 ones second-order cones, [a b; b c] >= 0 being |(a - c, 2b)| <= a + c,
which halves the time of a solve; larger ones scaled upper triangles, column by column.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from robust_core.rational import Floats

_ROOT2 = float(np.sqrt(2.0))


@dataclass(frozen=True, slots=True)
class Cone:
    """How one stack of K matrices (n, n) is laid out in rows."""

    blocks: int
    size: int

    @property
    def rows_each(self) -> int:
        """Rows of one matrix."""
        return self.size * (self.size + 1) // 2

    @property
    def rows(self) -> int:
        """Rows of the stack."""
        return self.blocks * self.rows_each

    def to_rows(self, matrices: Floats) -> Floats:
        """(..., K, n, n) -> (..., K * rows_each)."""
        if self.size == 2:
            a, b, c = matrices[..., 0, 0], matrices[..., 0, 1], matrices[..., 1, 1]
            rows = np.stack([a + c, a - c, 2.0 * b], axis=-1)
        else:
            row, column, scale = _triangle(self.size)
            rows = matrices[..., row, column] * scale
        return rows.reshape(*matrices.shape[:-3], self.rows)

    def to_matrices(self, rows: Floats) -> Floats:
        """(K * rows_each,) -> (K, n, n), the inverse of :meth:`to_rows`."""
        parts = rows.reshape(self.blocks, self.rows_each)
        out = np.empty((self.blocks, self.size, self.size))
        if self.size == 2:
            out[:, 0, 0], out[:, 1, 1] = 0.5 * (parts[:, 0] + parts[:, 1]), 0.5 * (parts[:, 0] - parts[:, 1])
            out[:, 0, 1] = out[:, 1, 0] = 0.5 * parts[:, 2]
        else:
            row, column, scale = _triangle(self.size)
            out[:, row, column] = out[:, column, row] = parts / scale
        return out

    def least_eigenvalue(self, rows: Floats) -> float:
        """Smallest eigenvalue of all matrices whose rows these are."""
        if self.size == 2:
            parts = rows.reshape(self.blocks, 3)
            return float((0.5 * (parts[:, 0] - np.hypot(parts[:, 1], parts[:, 2]))).min())
        return float(np.linalg.eigvalsh(self.to_matrices(rows)).min())

    def traces(self, rows: Floats) -> Floats:
        """(..., K * rows_each) -> (...): the sum of all traces."""
        if self.size == 2:
            return np.asarray(rows[..., ::3].sum(axis=-1))
        row, column, _ = _triangle(self.size)
        diagonal = np.tile(row == column, self.blocks)
        return np.asarray(rows[..., diagonal].sum(axis=-1))

    def multipliers(self, rows: Floats) -> Floats:
        """Matrices Z (K, n, n) with <Z, M> = rows . to_rows(M) for every M."""
        parts = rows.reshape(self.blocks, self.rows_each)
        out = np.empty((self.blocks, self.size, self.size))
        if self.size == 2:
            out[:, 0, 0], out[:, 1, 1] = parts[:, 0] + parts[:, 1], parts[:, 0] - parts[:, 1]
            out[:, 0, 1] = out[:, 1, 0] = parts[:, 2]
        else:
            row, column, scale = _triangle(self.size)
            out[:, row, column] = parts / scale
            out[:, column, row] = parts / scale
        return out


@lru_cache(maxsize=64)
def _triangle(size: int) -> tuple[np.ndarray, np.ndarray, Floats]:
    pairs = [(row, column) for column in range(size) for row in range(column + 1)]
    row, column = (np.array(part, dtype=np.intp) for part in zip(*pairs, strict=True))
    return row, column, np.where(row == column, 1.0, _ROOT2)
