"""Theorem 2.4 as printed: a baseline that has no solution where the thesis uses it, and says why.

For any gains it asks P_z > I / eps > P_r > I / (eps (1 + lambda)) and, for all i, j,
[He(A_j P_i + B_j Q_ij), P_i; P_i, -I / (eps (1 + lambda) sum_{r != z} |phi_r|)] < 0. The printed K_j = Q_ij P_i^-1 for
all i couples the unknowns bilinearly; here the Q_ij are free, which only helps: where even that is infeasible, so is
the printed theorem (erratum 2.3.6). eps scales out and is one more unknown.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from robust_core.errors import ArgumentError
from robust_core.lmi import Constraint, Unknown, Unknowns, he
from robust_core.lmi.constraint import blocks
from robust_core.lmi.unknowns import Values
from robust_core.rational import exact_array, rational, to_float
from robust_core.theorems.base import Data, Theorem, exact_option


@dataclass(frozen=True)
class PrintedStabilisation(Theorem):
    """(2.3.5), (2.3.6) with free Q_ij, for one lambda; ``z`` is the fastest weight unless given."""

    NAME = "2.4 (printed)"
    PROVES = "that the relaxed printed inequalities have a solution, which is not yet a controller"
    USES_RATES = True
    growth: Any = "1/10"
    z: int = -1

    def __post_init__(self) -> None:
        object.__setattr__(self, "growth", exact_option("growth", self.growth))
        if rational(self.growth) <= 0:
            raise ArgumentError("growth", "positive (lambda of Theorem 2.4)", self.growth)

    def specialised(self, model: Any) -> "PrintedStabilisation":
        """With z filled; RateError without rates, ArgumentError without inputs."""
        bounds = model.require_rates("theorem 2.4")
        if model.B is None:
            raise ArgumentError("model", "a system with inputs", "one without B")
        if self.z >= model.count:
            raise ArgumentError("z", f"a weight 0..{model.count - 1}", str(self.z))
        return self if self.z >= 0 else PrintedStabilisation(self.growth, int(np.argmax(np.abs(bounds.high))))

    def data(self, model: Any, *, exact: bool = False, bound: str = "high") -> Data:
        """The model's arrays, 1 + lambda, and the sum of the other rates."""
        data = dict(super().data(model, exact=exact, bound=bound))
        factor = 1 + rational(self.growth)
        data["factor"] = factor if exact else float(to_float(np.array(factor, dtype=object)))
        data["speed"] = sum(data["phi"][r] for r in range(model.count) if r != self.z)
        data["unit"] = exact_array(np.eye(model.states)) if exact else np.eye(model.states)
        return data

    def unknowns(self, model: Any) -> Unknowns:
        """P (m, n, n), Q (m m, r, n) in the order i, j, and 1 / eps."""
        n, m = model.states, model.count
        return Unknowns(
            (
                Unknown("P", n, count=m, symmetric=True),
                Unknown("Q", model.B.shape[2], n, count=m * m),
                Unknown("scale", 1),
            )
        )

    def constraints(self, data: Data, values: Values) -> Sequence[Constraint]:
        """(2.3.5) and (2.3.6), homogeneous in P, Q and 1 / eps."""
        P, scale, factor, unit = values["P"], values["scale"][..., None, :, :], data["factor"], data["unit"]
        m, n = P.shape[-3], P.shape[-1]
        others = [r for r in range(m) if r != self.z]
        Q = values["Q"].reshape(*P.shape[:-3], m, m, *values["Q"].shape[-2:])
        flow = he(data["A"] @ P[..., :, None, :, :] + data["B"] @ Q)
        edge = P[..., :, None, :, :] + 0 * flow
        corner = (-1 / (data["speed"] * factor)) * scale[..., None, :, :] * unit + 0 * flow
        block = blocks([[flow, edge], [edge, corner]]).reshape(*P.shape[:-3], m * m, 2 * n, 2 * n)
        return (
            Constraint("P_z > I / eps", P[..., [self.z], :, :] - scale * unit, sized=True),
            Constraint("P_r < I / eps", scale * unit - P[..., others, :, :]),
            Constraint("P_r > I / (eps (1 + lambda))", factor * P[..., others, :, :] - scale * unit, sized=True),
            Constraint("(2.3.6) < 0", -block),
        )
