"""Theorem 2.3: the rates of the weights sum to zero, so that one of them can be eliminated."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Self

import numpy as np

from robust_core.errors import ArgumentError
from robust_core.lmi import Constraint, Unknowns
from robust_core.lmi.unknowns import Values
from robust_core.theorems.base import Data
from robust_core.theorems.lyapunov import LyapunovTheorem, one_per_vertex, pair_products, weighted


@dataclass(frozen=True)
class Relaxed(LyapunovTheorem):
    """P_r >= P_z > 0 with 1/2 He(P_i A_j + P_j A_i) + sum_{r != z} phi_r (P_r - P_z) < 0, (2.2.7)-(2.2.8).

    ``z`` is the weight whose rate is eliminated, with the minus sign that (2.2.6) lacks; None takes the largest phi,
    the first of those whose enclosures do not tell them apart (at many points of example 2.4.1 two are equal).
    The ordering P_r >= P_z cannot be left out: without it every point of example 2.4.1 is falsely feasible (erratum
    2.2.7). The conclusion is local, not global (erratum 2.3), and the theorem does not contain theorem 2.2 (erratum
    2.2.11); :class:`~robust_core.theorems.slack.Slack` contains both.
    """

    NAME = "2.3"
    PROVES = "local exponential stability while the rates keep their bounds"
    USES_RATES = True
    AFFINE = ("A", "phi")
    z: int | None = None

    def specialised(self, model: Any) -> Self:
        """With z chosen; RateError without rates."""
        rates = model.require_rates("theorem 2.3")
        if self.z is None:
            return replace(self, z=int(np.flatnonzero(rates.high >= rates.low.max())[0]))
        if not 0 <= self.z < model.count:
            raise ArgumentError("z", f"a weight 0..{model.count - 1}", repr(self.z))
        return self

    def unknowns(self, model: Any) -> Unknowns:
        """P (m, n, n)."""
        return one_per_vertex(model)

    def constraints(self, data: Data, values: Values) -> Sequence[Constraint]:
        """P_r > 0, the ordering and (2.2.8)."""
        P, z = values["P"], self.z
        others = [r for r in range(P.shape[-3]) if r != z]
        excess = P[..., others, :, :] - P[..., [z], :, :]
        derivative = pair_products(P, data["A"], data) + weighted(data["phi"][..., others], excess)[..., None, :, :]
        return (
            Constraint("P_r > 0", P, sized=True),
            *([Constraint("(2.2.7) P_r - P_z >= 0", excess, strict=False)] if others else []),
            Constraint("(2.2.8) < 0", -derivative),
        )
