"""Linear objectives under LMIs with large blocks and few unknowns: an interior-point method on the normal equations.

A sparse solver factors one dense square of n (n + 1) / 2 rows per block of size n, the normal equations only one of as
many rows as there are unknowns. Primal and dual steps in the scaling of Nesterov and Todorov with Mehrotra's
corrector (Vandenberghe: The CVXOPT linear and quadratic cone program solvers, 2010), on

    min c.y   subject to   S_k = F_k(y) >= 0,      multipliers X_k >= 0 with sum_k tr(F_ki X_k) = c_i.

Its answers are those of any solver: candidates, that prove nothing until they are verified.
"""

import time
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from robust_core.errors import SolverLimitError
from robust_core.lmi.coefficients import Family
from robust_core.lmi.conic import ConicSolution
from robust_core.lmi.layout import Layout
from robust_core.lmi.row_blocks import RowBlocks
from robust_core.lmi.settings import SolverSettings
from robust_core.rational import Floats

_FEWEST_OPERATIONS = 5e7
_LONGEST = 0.98
_RIDGE = 1e-13
_GIVE_UP = 80
_ENDLESS = 1e12
"""Where there is no interior or no minimum, iterates grow without end."""


def pays(families: Sequence[Family]) -> bool:
    """Whether a sparse factorisation would take so many operations that this method is the faster one."""
    operations = 0.0
    for family in families:
        rows = family.constant.shape[-1] * (family.constant.shape[-1] + 1) / 2
        operations += family.linear.shape[1] * rows**2 * (rows / 3.0 + family.linear.shape[0])
    return operations > _FEWEST_OPERATIONS


def minimise_large(families: Sequence[Family], linear: Floats, settings: SolverSettings) -> ConicSolution | None:
    """A solution, or None where the method gets no further: no interior, no minimum, or lost digits.

    Raises
    ------
    SolverLimitError: if the time ran out.
    """
    try:
        return _Run(families, linear, settings).solve()
    except np.linalg.LinAlgError:
        return None


@dataclass(frozen=True, slots=True)
class _Normal:
    """Normal equations, their rows' and columns' units, and a Cholesky factor of them in these."""

    matrix: Floats
    units: Floats
    factor: Any

    @staticmethod
    def of(matrix: Floats) -> "_Normal":
        from scipy.linalg import cho_factor

        units: Floats = 1.0 / np.sqrt(np.diag(matrix) + 1e-300)
        return _Normal(matrix, units, cho_factor(units[:, None] * matrix * units + _RIDGE * np.eye(len(units))))

    def solve(self, right: Floats) -> Floats:
        """Two refinements make good what keeps the factor positive."""
        from scipy.linalg import cho_solve

        found: Floats = self.units * cho_solve(self.factor, self.units * right)
        for _ in range(2):
            found = found + self.units * cho_solve(self.factor, self.units * (right - self.matrix @ found))
        return found


@dataclass(frozen=True, slots=True)
class _Scaled:
    """One iterate in its scaling: R with R'S R = R^-1 X R^-T = diag(D), and the coefficients R'F_i R, packed."""

    R: list[Floats]
    D: list[Floats]
    coefficients: list[Floats]
    normal: _Normal


class _Run:
    def __init__(self, families: Sequence[Family], linear: Floats, settings: SolverSettings) -> None:
        self.families, self.c, self.settings = families, linear, settings
        self.blocks = [RowBlocks.of(family) for family in families]
        self.degree = float(sum(block.count * block.size for block in self.blocks))
        # Starts well outside the answer: the method reaches the interior from afar, but not from too close.
        norms = [np.sqrt((family.linear**2).sum(axis=(1, 2, 3)).max(initial=0.0)) for family in families]
        far = 10.0 * (1.0 + max(norms))
        eyes = [np.tile(np.eye(block.size), (block.count, 1, 1)) for block in self.blocks]
        self.y, self.S, self.X = np.zeros(len(linear)), [far * eye for eye in eyes], [10.0 * eye for eye in eyes]

    def solve(self) -> ConicSolution | None:
        began, tolerance = time.monotonic(), self.settings.tolerance
        scale = 1.0 + max(float(np.abs(block.constant).max()) for block in self.blocks)
        for iteration in range(min(_GIVE_UP, self.settings.iterations)):
            missing = [block.at(self.y) - S for block, S in zip(self.blocks, self.S, strict=True)]
            unpaid = self.c - sum(block.adjoint(X) for block, X in zip(self.blocks, self.X, strict=True))
            gap = float(sum((S * X).sum() for S, X in zip(self.S, self.X, strict=True)))
            outside = max(float(np.abs(one).max()) for one in missing) / scale
            owed = float(np.abs(unpaid).max()) / (1.0 + float(np.abs(self.c).max()))
            # Degenerate optima cost the multipliers digits, but not y: it keeps the inequalities.
            if (
                outside < tolerance
                and owed < 100.0 * tolerance
                and gap < 10.0 * tolerance * (1.0 + abs(self.c @ self.y))
            ):
                return self._solution(iteration)
            if not max(gap, float(np.abs(self.y).max())) < _ENDLESS:
                return None
            if time.monotonic() - began > self.settings.time_limit_s:
                raise SolverLimitError("the solver stopped at its limit (MaxTime); allow more, or scale the model")
            self._step(missing, unpaid, gap / self.degree)
        return None

    def _step(self, missing: list[Floats], unpaid: Floats, mu: float) -> None:
        scaled = self._scaling()
        turned = [_t(R) @ one @ R for R, one in zip(scaled.R, missing, strict=True)]
        squares = [D[:, :, None] ** 2 * np.eye(D.shape[-1]) for D in scaled.D]
        _, dS, dX = self._direction(scaled, turned, unpaid, [-square for square in squares])
        reached = min(1.0, self._longest(scaled, dS), self._longest(scaled, dX))
        sigma, corrected = (1.0 - reached) ** 3, []
        for square, s, x in zip(squares, dS, dX, strict=True):
            product = x @ s
            corrected.append(sigma * mu * np.eye(square.shape[-1]) - square - 0.5 * (product + _t(product)))
        dy, dS, dX = self._direction(scaled, turned, unpaid, corrected)
        length = min(1.0, _LONGEST * self._longest(scaled, dS), _LONGEST * self._longest(scaled, dX))
        self.y = self.y + length * dy
        for k, R in enumerate(scaled.R):
            back = np.linalg.inv(R)
            S, X = self.S[k] + length * (_t(back) @ dS[k] @ back), self.X[k] + length * (R @ dX[k] @ _t(R))
            self.S[k], self.X[k] = 0.5 * (S + _t(S)), 0.5 * (X + _t(X))

    def _scaling(self) -> _Scaled:
        size = len(self.c)
        found, diagonals, coefficients, normal = [], [], [], np.zeros((size, size))
        for block, S, X in zip(self.blocks, self.S, self.X, strict=True):
            L, G = np.linalg.cholesky(S), np.linalg.cholesky(X)
            U, D, _ = np.linalg.svd(_t(G) @ L)
            R = G @ U / np.sqrt(D)[:, None, :]
            packed = block.congruent(R)
            normal[np.ix_(block.used, block.used)] += packed @ packed.T
            found.append(R)
            diagonals.append(D)
            coefficients.append(packed)
        return _Scaled(found, diagonals, coefficients, _Normal.of(normal))

    def _direction(
        self, scaled: _Scaled, missing: list[Floats], unpaid: Floats, target: list[Floats]
    ) -> tuple[Floats, list[Floats], list[Floats]]:
        """Step of y, and of S and X in the scaling, for a target of (D dS + dS D + D dX + dX D) / 2."""
        wished = [2.0 * T / (D[:, :, None] + D[:, None, :]) for T, D in zip(target, scaled.D, strict=True)]
        right = -unpaid
        for block, packed, one, gone in zip(self.blocks, scaled.coefficients, wished, missing, strict=True):
            right[block.used] += packed @ block.pack(one - gone)
        dy = scaled.normal.solve(right)
        dS = [
            block.unpack(dy[block.used] @ packed) + gone
            for block, packed, gone in zip(self.blocks, scaled.coefficients, missing, strict=True)
        ]
        return dy, dS, [one - step for one, step in zip(wished, dS, strict=True)]

    @staticmethod
    def _longest(scaled: _Scaled, steps: list[Floats]) -> float:
        """Largest step that keeps diag(D) + step >= 0."""
        low = min(
            float(np.linalg.eigvalsh(step / np.sqrt(D[:, :, None] * D[:, None, :])).min())
            for step, D in zip(steps, scaled.D, strict=True)
        )
        return float("inf") if low >= 0.0 else -1.0 / low

    def _solution(self, iterations: int) -> ConicSolution:
        layout = Layout.of(self.families, with_margin=False, with_size=False)
        return ConicSolution(
            vector=self.y,
            margin=0.0,
            multipliers=tuple(self.X),
            objective=float(self.c @ self.y),
            status="Solved",
            iterations=iterations,
            margins=layout.margins(layout.rows(self.families), self.y),
        )


def _t(matrices: Any) -> Any:
    return np.swapaxes(matrices, -1, -2)
