"""The slack form, which contains theorems 2.1, 2.2 and 2.3 (the latter for every z)."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Self

from robust_core.lmi import Constraint, Unknown, Unknowns
from robust_core.lmi.unknowns import Values
from robust_core.theorems.base import Data
from robust_core.theorems.lyapunov import LyapunovTheorem, pair_products, weighted


@dataclass(frozen=True)
class Slack(LyapunovTheorem):
    """P_r > 0, P_r + X >= 0 with 1/2 He(P_i A_j + P_j A_i) + sum_r phi_r (P_r + X) < 0 (erratum 2.2.11).

    Rates sum to zero, so any symmetric X may be added to all P_r under them: X = 0 is theorem 2.2, X = -P_z 2.3,
    X = -P with equal P_r 2.1.
    """

    NAME = "slack"
    PROVES = "local exponential stability while the rates keep their bounds"
    USES_RATES = True
    AFFINE = ("A", "phi")

    def specialised(self, model: Any) -> Self:
        """Itself; RateError without rates."""
        model.require_rates("the slack form")
        return self

    def unknowns(self, model: Any) -> Unknowns:
        """P (m, n, n) and X (n, n)."""
        size = model.states
        return Unknowns((Unknown("P", size, count=model.count, symmetric=True), Unknown("X", size, symmetric=True)))

    def constraints(self, data: Data, values: Values) -> Sequence[Constraint]:
        """P_r > 0, P_r + X >= 0 and the derivative."""
        P, shifted = values["P"], values["P"] + values["X"][..., None, :, :]
        derivative = pair_products(P, data["A"], data) + weighted(data["phi"], shifted)[..., None, :, :]
        return (
            Constraint("P_r > 0", P, sized=True),
            Constraint("P_r + X >= 0", shifted, strict=False),
            Constraint("derivative < 0", -derivative),
        )
