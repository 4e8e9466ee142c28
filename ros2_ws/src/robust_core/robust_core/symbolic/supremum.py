"""Suprema over a box of many functions at once: f_n(x) = sum_k w_nk g_k(x), by branch and bound.

All n share the cells and the interval evaluations of g and its gradient; only sums of floats are done per function,
with their rounding accounted for. On each cell the mean-value form gives an upper and a lower bound of the supremum
that differ by the square of the cell's size.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from robust_core.errors import EnclosureError
from robust_core.rational import Floats
from robust_core.symbolic.interval import BallFunction, box_balls, middles_and_radii
from robust_core.symbolic.packages import casadi_module

_ROUNDING = 2.0**-46
_START = 4
_FLOOR = 1e-9
"""Gap that is always enough, relative to the bounds on the first cells: a supremum may be zero."""


@dataclass(frozen=True, slots=True)
class Cells:
    """Sides (C, d) of cells, values of g at their middles (C, K) and gradients over them (C, d, K), with radii."""

    low: Floats
    high: Floats
    value: Floats
    value_radius: Floats
    gradient: Floats
    gradient_radius: Floats

    def bounds(self, weights: Floats) -> tuple[Floats, Floats]:
        """Upper bounds of f_n over each cell, and lower bounds of its supremum there, both (C, N)."""
        half = 0.5 * (self.high - self.low) * (1.0 + 2.0**-50)
        w, size = weights.T, np.abs(weights).T
        middle = self.value @ w
        slope = np.abs(np.einsum("cdk,kn->dcn", self.gradient, w))
        spread = np.einsum("cdk,kn->dcn", self.gradient_radius, size)
        reach = half.T[:, :, None]
        gain, doubt = (reach * slope).sum(axis=0), (reach * spread).sum(axis=0)
        magnitude = np.abs(self.value) @ size + (reach * np.einsum("cdk,kn->dcn", np.abs(self.gradient), size)).sum(
            axis=0
        )
        doubt = doubt + self.value_radius @ size + _ROUNDING * (magnitude + doubt)
        return middle + gain + doubt, middle + gain - doubt

    def halved(self, keep: Any, weights: Floats) -> tuple[Floats, Floats]:
        """Corners of the kept cells, each cut across the side that its bounds doubt most."""
        half = 0.5 * (self.high - self.low)[keep]
        spread = (self.gradient_radius[keep] * np.abs(weights).max(axis=0)).sum(axis=2)
        axis = (spread * half + 1e-9 * half * (spread > 0.0)).argmax(axis=1)
        rows = np.arange(len(axis))
        low, high = self.low[keep], self.high[keep]
        cut = 0.5 * (low[rows, axis] + high[rows, axis])
        left, right = high.copy(), low.copy()
        left[rows, axis], right[rows, axis] = cut, cut
        return np.concatenate([low, right]), np.concatenate([left, high])


class Supremum:
    """Encloses sup over a box of sum_k w_k g_k(x) for given g.

    Parameters
    ----------
    functions: CasADi column (K, 1) of g_k.
    variables: CasADi column (d, 1).
    """

    def __init__(self, functions: Any, variables: Any) -> None:
        casadi = casadi_module()
        self.count = int(functions.numel())
        self._value = BallFunction(functions, variables)
        self._gradient = BallFunction(casadi.jacobian(functions, variables), variables)
        self.dimensions = int(variables.numel())

    def enclose(
        self,
        low: Floats,
        high: Floats,
        weights: Floats,
        *,
        relative: float = 1e-6,
        cells: int = 100_000,
        progress: Callable[[str], None] | None = None,
    ) -> tuple[Floats, Floats]:
        """Lower and upper bounds (N,) of the suprema over [low, high], for weights (N, K).

        The gap is at most ``relative`` times the supremum's magnitude; where the branch and bound has used up its
        ``cells`` before, the bounds are wider, but still bounds.

        Raises
        ------
        EnclosureError: if an expression has no finite enclosure.
        """
        box_low, box_high = np.atleast_2d(low), np.atleast_2d(high)
        for axis in range(self.dimensions):
            box_low, box_high = _cut(box_low, box_high, axis, _START)
        best = np.full(len(weights), -np.inf)
        settled = np.full(len(weights), -np.inf)
        floor = np.zeros(len(weights))
        used = 0
        while True:
            current = self._evaluate(box_low, box_high)
            used += len(box_low)
            upper, lower = _in_chunks(current, weights)
            best = np.maximum(best, lower.max(axis=0))
            if used == len(box_low):
                floor = _FLOOR * np.maximum(np.abs(upper), np.abs(lower)).max(axis=0)
            open_cells = upper > best + relative * np.abs(best) + floor
            keep = open_cells.any(axis=1)
            settled = np.maximum(settled, np.where(keep[:, None], -np.inf, upper).max(axis=0))
            if progress is not None:
                progress(f"{used} cells, {int(keep.sum())} open")
            if not keep.any() or used + 2 * keep.sum() > cells:
                rest = upper[keep].max(axis=0) if keep.any() else np.full(len(weights), -np.inf)
                return best, np.maximum(np.maximum(settled, rest), best)
            box_low, box_high = current.halved(keep, weights)

    def _evaluate(self, low: Floats, high: Floats) -> Cells:
        count, d, k = len(low), self.dimensions, self.count
        value, value_radius = np.empty((count, k)), np.empty((count, k))
        gradient, gradient_radius = np.empty((count, d, k)), np.empty((count, d, k))
        middle = 0.5 * (low + high)
        for cell in range(count):
            value[cell], value_radius[cell] = middles_and_radii(self._value(box_balls(middle[cell], middle[cell])))
            m, r = middles_and_radii(self._gradient(box_balls(low[cell], high[cell])))
            # CasADi stacks the columns of the Jacobian (K, d) on one another.
            gradient[cell], gradient_radius[cell] = m.reshape(d, k), r.reshape(d, k)
        return Cells(low, high, value, value_radius, gradient, gradient_radius)


def _cut(low: Floats, high: Floats, axis: int, parts: int) -> tuple[Floats, Floats]:
    edges = np.linspace(low[:, axis], high[:, axis], parts + 1)
    edges[0], edges[-1] = low[:, axis], high[:, axis]
    lows, highs = [], []
    for k in range(parts):
        left, right = low.copy(), high.copy()
        left[:, axis], right[:, axis] = edges[k], edges[k + 1]
        lows.append(left)
        highs.append(right)
    return np.concatenate(lows), np.concatenate(highs)


def _in_chunks(cells: Cells, weights: Floats) -> tuple[Floats, Floats]:
    size = max(1, 2_000_000 // max(1, len(cells.low)))
    parts = [cells.bounds(weights[start : start + size]) for start in range(0, len(weights), size)]
    upper, lower = (np.concatenate(part, axis=1) for part in zip(*parts, strict=True))
    if not np.isfinite(upper).all():
        raise EnclosureError("bounds overflow: scale the variables")
    return upper, lower
