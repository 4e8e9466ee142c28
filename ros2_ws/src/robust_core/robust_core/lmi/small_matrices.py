"""Stacks of small symmetric matrices: closed forms for 2 x 2, LAPACK for larger ones."""

import numpy as np

from robust_core.rational import Floats


class Triangle:
    """Symmetric matrices (n, n) as vectors of length p = n (n + 1) / 2 that keep inner products."""

    def __init__(self, size: int) -> None:
        self.size = size
        self.row, self.column = np.triu_indices(size)
        diagonal = self.row == self.column
        self._scale = np.where(diagonal, 1.0, np.sqrt(2.0))
        share = np.where(diagonal, np.sqrt(0.5), 1.0)
        self._outer = share[:, None] * share[None, :]
        self._positions = np.zeros((size, size), dtype=np.intp)
        self._positions[self.row, self.column] = self._positions[self.column, self.row] = np.arange(len(self.row))

    def pack(self, matrices: Floats) -> Floats:
        """(..., n, n) -> (..., p)."""
        return np.asarray(matrices[..., self.row, self.column] * self._scale)

    def pack_sum(self, matrices: Floats) -> Floats:
        """pack(M + M') for matrices (..., n, n) that need not be symmetric."""
        flat = matrices.reshape(*matrices.shape[:-2], -1)
        out = flat.take(self.row * self.size + self.column, axis=-1)
        out += flat.take(self.column * self.size + self.row, axis=-1)
        out *= self._scale
        return np.asarray(out)

    def unpack(self, vectors: Floats) -> Floats:
        """(..., p) -> (..., n, n)."""
        return np.asarray((vectors / self._scale)[..., self._positions])

    def congruence(self, W: Floats) -> Floats:
        """Matrices (..., p, p) of the map D -> W D W on packed vectors."""
        i, j = self.row[:, None], self.column[:, None]
        k, m = self.row[None, :], self.column[None, :]
        return np.asarray(self._outer * (W[..., i, k] * W[..., j, m] + W[..., i, m] * W[..., j, k]))


def inverse(matrices: Floats) -> Floats:
    """Inverses of (..., n, n)."""
    if matrices.shape[-1] != 2:
        return np.asarray(np.linalg.inv(matrices))
    a, b, c = matrices[..., 0, 0], matrices[..., 0, 1], matrices[..., 1, 1]
    determinant = a * c - b * b
    out = np.empty_like(matrices)
    out[..., 0, 0], out[..., 1, 1] = c / determinant, a / determinant
    out[..., 0, 1] = out[..., 1, 0] = -b / determinant
    return out


def least_eigenvalue(matrices: Floats) -> Floats:
    """Smallest eigenvalues of (..., n, n)."""
    if matrices.shape[-1] != 2:
        return np.asarray(np.linalg.eigvalsh(matrices)[..., 0])
    a, b, c = matrices[..., 0, 0], matrices[..., 0, 1], matrices[..., 1, 1]
    return np.asarray(0.5 * (a + c) - np.hypot(0.5 * (a - c), b))


def largest_step(matrices: Floats, changes: Floats) -> Floats:
    """Largest alpha (N,) with M + alpha dM >= 0 for all K positive definite M (N, K, n, n); inf if any will do."""
    if matrices.shape[-1] == 2:
        # Least eigenvalue of M^-1 dM, from its trace and determinant.
        inner = inverse(matrices)
        half = 0.5 * (inner * changes).sum(axis=(-2, -1))
        determinant = _determinant(changes) / _determinant(matrices)
        least = half - np.sqrt(np.maximum(half * half - determinant, 0.0))
    else:
        factor = np.linalg.inv(np.linalg.cholesky(matrices))
        least = np.linalg.eigvalsh(factor @ changes @ np.swapaxes(factor, -1, -2))[..., 0]
    worst = least.min(axis=-1)
    return np.where(worst < 0.0, -1.0 / np.minimum(worst, -1e-300), np.inf)


def _determinant(matrices: Floats) -> Floats:
    return np.asarray(matrices[..., 0, 0] * matrices[..., 1, 1] - matrices[..., 0, 1] ** 2)
