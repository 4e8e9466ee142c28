"""Coefficients of a constraint by their non-zero rows, which makes congruences with all of them cheap."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robust_core.lmi.coefficients import Family
from robust_core.lmi.small_matrices import Triangle
from robust_core.rational import Floats


@dataclass(frozen=True)
class RowBlocks:
    """``count`` blocks of ``size`` with F(y) = constant + sum_i y_i (U_i + U_i'), U_i upper triangular.

    used: (u,) unknowns that occur. rows: (u, r) rows of U_i that are not zero in some block, repeated where there are
    fewer than r. values: (K, u, r, n) those rows, zero where repeated.
    """

    count: int
    size: int
    constant: Floats
    flat: Floats
    used: NDArray[np.intp]
    rows: NDArray[np.intp]
    values: Floats
    triangle: Triangle
    unknowns: int

    @staticmethod
    def of(family: Family) -> "RowBlocks":
        """The same constraint."""
        unknowns, count, size = family.linear.shape[:3]
        used = np.flatnonzero((family.linear != 0.0).any(axis=(1, 2, 3)))
        linear = family.linear[used]
        half = np.triu(linear)
        half[..., np.arange(size), np.arange(size)] *= 0.5
        filled = (half != 0.0).any(axis=(1, 3))
        most = max(int(filled.sum(axis=1).max(initial=0)), 1)
        # Rows that are not zero come first; what follows them is zero anyway.
        rows = np.argsort(~filled, axis=1, kind="stable")[:, :most]
        values = np.take_along_axis(half, rows[:, None, :, None], axis=2).transpose(1, 0, 2, 3)
        flat = linear.transpose(1, 0, 2, 3).reshape(count, len(used), size * size)
        constant = np.broadcast_to(family.constant, (count, size, size))
        triangle = Triangle(size)
        return RowBlocks(
            count,
            size,
            constant,
            np.ascontiguousarray(flat),
            used,
            rows,
            np.ascontiguousarray(values),
            triangle,
            unknowns,
        )

    def at(self, vector: Floats) -> Floats:
        """F(y), (K, n, n)."""
        moved = np.matmul(vector[self.used], self.flat).reshape(self.constant.shape)
        return np.asarray(self.constant + moved)

    def adjoint(self, multipliers: Floats) -> Floats:
        """sum_k tr(F_ki X_k) of every unknown."""
        out = np.zeros(self.unknowns)
        out[self.used] = np.matmul(self.flat, multipliers.reshape(self.count, -1, 1)).sum(axis=0)[:, 0]
        return out

    def congruent(self, R: Floats) -> Floats:
        """R'F_i R of every unknown that occurs, packed: (u, K p)."""
        u, r = self.rows.shape
        turned = np.matmul(self.values.reshape(self.count, u * r, self.size), R)
        beside = np.swapaxes(R[:, self.rows], -1, -2)
        product = np.matmul(beside, turned.reshape(self.count, u, r, self.size))
        return np.ascontiguousarray(self.triangle.pack_sum(product).transpose(1, 0, 2)).reshape(u, -1)

    def pack(self, matrices: Floats) -> Floats:
        """(K, n, n) as one vector (K p,) that keeps inner products."""
        return self.triangle.pack(matrices).ravel()

    def unpack(self, vector: Floats) -> Floats:
        """The reverse of `pack`."""
        return self.triangle.unpack(vector.reshape(self.count, -1))
