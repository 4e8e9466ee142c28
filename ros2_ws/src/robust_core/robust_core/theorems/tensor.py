"""Tensor-product forms T1 and T2: they know which weights sum to what (erratum 2.2.11).

Weights of one group sum to a constant, so their rates sum to zero within the group and fill a simplex: at each of its
corners all but one rate are at their bounds. T1 checks the derivative at those corners instead of ordering the P_r; T2
also replaces the vertices by the attained ones, with the coefficients of the product in Bernstein form.
"""

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from robust_core.lmi import Constraint, Unknown, Unknowns, he
from robust_core.lmi.unknowns import Values
from robust_core.models.simplices import Simplices
from robust_core.rational import to_float
from robust_core.theorems.base import Data
from robust_core.theorems.lyapunov import LyapunovTheorem, one_per_vertex, pair_products, weighted

Groups = tuple[tuple[int, ...], ...]


def rate_terms(phi: Any, P: Any, groups: Groups) -> Any:
    """sum_r sigma_r' P_r at all corners of the rates, stacked (..., corners, n, n)."""
    total = None
    for group in groups:
        corners = []
        for z in group:
            others = [r for r in group if r != z]
            excess = P[..., others, :, :] - P[..., [z], :, :]
            corners.append(weighted(phi[..., others], excess))
        stack = np.stack(corners, axis=-3)
        if total is None:
            total = stack
        else:
            total = total[..., :, None, :, :] + stack[..., None, :, :, :]
            total = total.reshape(*total.shape[:-4], total.shape[-4] * total.shape[-3], *total.shape[-2:])
    return total


def _at_corners(derivative: Any, rates: Any) -> Any:
    """Every block of the derivative with every corner of the rates, in one stack."""
    both = derivative[..., :, None, :, :] + rates[..., None, :, :, :]
    return both.reshape(*both.shape[:-4], both.shape[-4] * both.shape[-3], *both.shape[-2:])


@dataclass(frozen=True)
class TensorCorners(LyapunovTheorem):
    """T1: P_r > 0 and 1/2 He(P_i A_j + P_j A_i) + sum_r sigma_r' P_r < 0 at all corners of the rates, i <= j."""

    NAME = "T1"
    PROVES = "local exponential stability while the rates keep their bounds"
    USES_RATES = True
    AFFINE = ("A", "phi")
    groups: Groups | None = None

    def specialised(self, model: Any) -> Self:
        """With the model's groups; RateError without rates."""
        model.require_rates("theorem T1")
        return replace(self, groups=model.simplices.groups)

    def unknowns(self, model: Any) -> Unknowns:
        """P (m, n, n)."""
        return one_per_vertex(model)

    def constraints(self, data: Data, values: Values) -> Sequence[Constraint]:
        """P_r > 0 and the derivative at the corners."""
        P = values["P"]
        derivative = _at_corners(pair_products(P, data["A"], data), rate_terms(data["phi"], P, self.groups or ()))
        return (Constraint("P_r > 0", P, sized=True), Constraint("derivative < 0", -derivative))


@dataclass(frozen=True)
class TensorProduct(LyapunovTheorem):
    """T2: as T1, on the attained vertices, the product P(sigma) A(sigma) in Bernstein form of degree 2 per group.

    Only P at the attained vertices must be positive. Adding a matrix to all P_r of one group and taking it from another
    (per total) changes nothing, so the first P of every group but the first is zero.
    """

    NAME = "T2"
    PROVES = "local exponential stability while the rates keep their bounds"
    USES_RATES = True
    AFFINE = ("A", "phi")
    groups: Groups | None = None

    def specialised(self, model: Any) -> Self:
        """With the model's groups; RateError without rates."""
        model.require_rates("theorem T2")
        return replace(self, groups=model.simplices.groups)

    def data(self, model: Any, *, exact: bool = False, bound: str = "high") -> Data:
        """With the weights at the attained vertices."""
        mixing = model.simplices.mixing()
        return {**super().data(model, exact=exact, bound=bound), "mixing": mixing if exact else to_float(mixing)}

    def unknowns(self, model: Any) -> Unknowns:
        """P (m - groups + 1, n, n): those that are not fixed at zero, in the order of the weights."""
        free = model.count - len(model.simplices.groups) + 1
        return Unknowns((Unknown("P", model.states, count=free, symmetric=True),))

    def vertex_matrices(self, model: Any, values: Values) -> Any:
        """P (m, n, n) with the zeros filled in."""
        return self._filled(values["P"])

    def _filled(self, P: Any) -> Any:
        groups = self.groups or ()
        fixed = {group[0] for group in groups[1:]}
        count = sum(len(group) for group in groups)
        padded = np.concatenate([P, P[..., :1, :, :] * 0], axis=-3)
        free = iter(range(P.shape[-3]))
        return padded[..., [P.shape[-3] if r in fixed else next(free) for r in range(count)], :, :]

    def constraints(self, data: Data, values: Values) -> Sequence[Constraint]:
        """P > 0 at the attained vertices, and all Bernstein coefficients of the derivative at the corners."""
        groups = self.groups or ()
        P = self._filled(values["P"])
        at_vertices, A = _mixed(data["mixing"], P), _mixed(data["mixing"], data["A"])
        first, second = _orderings(groups)
        symmetric = he(at_vertices[..., :, None, :, :] @ A[..., None, :, :, :])
        product = symmetric[..., first, second, :, :].sum(axis=-3) * data["half"] ** len(groups)
        share = at_vertices[..., first, :, :].sum(axis=-3) * data["half"] ** len(groups)
        derivative = _at_corners(product + 2 * data["decay"] * share, rate_terms(data["phi"], P, groups))
        return (
            Constraint("P > 0 at the attained vertices", at_vertices, sized=True),
            Constraint("derivative < 0", -derivative),
        )


def _mixed(mixing: Any, matrices: Any) -> Any:
    flat = matrices.reshape(*matrices.shape[:-2], -1)
    mixed = mixing @ flat
    return mixed.reshape(*mixed.shape[:-1], *matrices.shape[-2:])


def _orderings(groups: Groups) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """For every Bernstein coefficient, the attained vertices (P, A) of all 2^groups products that contribute."""
    place = {choice: k for k, choice in enumerate(Simplices.of(sum(map(len, groups)), groups).choices())}
    first, second = [], []
    for pairs in itertools.product(*(itertools.combinations_with_replacement(group, 2) for group in groups)):
        orders = list(itertools.product(*((pair, pair[::-1]) for pair in pairs)))
        first.append([place[tuple(pair[0] for pair in order)] for order in orders])
        second.append([place[tuple(pair[1] for pair in order)] for order in orders])
    return np.array(first, dtype=np.intp), np.array(second, dtype=np.intp)
