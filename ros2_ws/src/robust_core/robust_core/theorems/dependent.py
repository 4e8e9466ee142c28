"""Theorem 2.2: a parameter-dependent Lyapunov function with bounded rates of the weights."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Self

from robust_core.lmi import Constraint, Unknowns
from robust_core.lmi.unknowns import Values
from robust_core.theorems.base import Data
from robust_core.theorems.lyapunov import LyapunovTheorem, one_per_vertex, pair_products, weighted


@dataclass(frozen=True)
class ParameterDependent(LyapunovTheorem):
    """P_r > 0 with 1/2 He(P_i A_j + P_j A_i) + sum_r phi_r P_r < 0 for i <= j, (2.2.2). Local: phi belongs to a box."""

    NAME = "2.2"
    PROVES = "local exponential stability while the rates keep their bounds"
    USES_RATES = True
    AFFINE = ("A", "phi")

    def specialised(self, model: Any) -> Self:
        """Itself; RateError without rates."""
        model.require_rates("theorem 2.2")
        return self

    def unknowns(self, model: Any) -> Unknowns:
        """P (m, n, n)."""
        return one_per_vertex(model)

    def constraints(self, data: Data, values: Values) -> Sequence[Constraint]:
        """P_r > 0 and (2.2.2)."""
        P = values["P"]
        derivative = pair_products(P, data["A"], data) + weighted(data["phi"], P)[..., None, :, :]
        return (Constraint("P_r > 0", P, sized=True), Constraint("(2.2.2) < 0", -derivative))
