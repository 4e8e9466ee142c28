"""Theorem 2.1: one quadratic Lyapunov function for all vertices."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from robust_core.lmi import Constraint, Unknown, Unknowns, he
from robust_core.lmi.unknowns import Values
from robust_core.theorems.base import Data
from robust_core.theorems.lyapunov import LyapunovTheorem


@dataclass(frozen=True)
class CommonLyapunov(LyapunovTheorem):
    """P > 0 with P A_i + A_i^T P + 2 decay P < 0 for all i, (2.2.1): stable for any motion of the weights."""

    NAME = "2.1"
    PROVES = "exponential stability for arbitrary weights"
    AFFINE = ("A",)

    def unknowns(self, model: Any) -> Unknowns:
        """P (n, n)."""
        return Unknowns((Unknown("P", model.states, symmetric=True),))

    def constraints(self, data: Data, values: Values) -> Sequence[Constraint]:
        """P > 0 and the vertices of (2.2.1)."""
        P = values["P"][..., None, :, :]
        derivative = he(P @ data["A"]) + 2 * data["decay"] * P
        return (Constraint("P > 0", P, sized=True), Constraint("(2.2.1) < 0", -derivative))

    def vertex_matrices(self, model: Any, values: Values) -> Any:
        """The same P at every vertex."""
        return values["P"][..., None, :, :].repeat(model.count, axis=-3)
