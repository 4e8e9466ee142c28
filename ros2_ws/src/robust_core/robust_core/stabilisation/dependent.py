"""Design D: vertex gains from a parameter-dependent Lyapunov function, in place of Theorem 2.4 (erratum 2.3.6).

With P~_r = X' P_r X, a common slack X and a scalar mu that is searched: P~_r > 0, P~_r >= P~_z, and for all i, j
[sum_r phi_r (P~_r - P~_z) + He(A_j X + B_j Y_j), P~_i - X + mu (A_j X + B_j Y_j)'; *, -mu (X + X')] < 0, K_j = Y_j
X^-1. The gains are then proven on their own by Theorem 2.3 for the closed loop.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from robust_core.analysis import Result, decide
from robust_core.checks import finite_number
from robust_core.errors import ArgumentError, RateError, SolverError
from robust_core.lmi import Constraint, Unknown, Unknowns, he
from robust_core.lmi.coefficients import coefficients
from robust_core.lmi.conic import ConicSolution
from robust_core.lmi.constraint import blocks, transpose
from robust_core.lmi.margin import MarginSolver
from robust_core.lmi.settings import SolverSettings
from robust_core.lmi.unknowns import Values
from robust_core.models import PolytopicSystem
from robust_core.rational import Floats, exact_array, to_float
from robust_core.stabilisation.design import Design
from robust_core.theorems import Relaxed
from robust_core.theorems.options import rounded
from robust_core.verdict import Verdict

MU_GRID = (1e-3, 2e-3, 5e-3, 1e-2, 2e-2)
"""Where mu is searched (s); larger ones leave no margin on the thesis's example."""


@dataclass(frozen=True, slots=True)
class DependentSynthesis:
    """The inequalities of design D in floats, for one mu and one z."""

    model: PolytopicSystem
    phi: Floats
    z: int
    mu: float
    decay: float
    gain_bound: float | None

    @property
    def unknowns(self) -> Unknowns:
        """P~ (m, n, n), X (n, n), Y (m, r, n)."""
        model = self.model
        assert model.B is not None
        n, m = model.states, model.count
        return Unknowns(
            (Unknown("P", n, count=m, symmetric=True), Unknown("X", n), Unknown("Y", model.B.shape[2], n, count=m))
        )

    def constraints(self, values: Values) -> list[Constraint]:
        """All inequalities; homogeneous."""
        model, z = self.model, self.z
        assert model.B is not None
        P, X, Y = values["P"], values["X"][..., None, :, :], values["Y"]
        others = [r for r in range(model.count) if r != z]
        above = P[..., others, :, :] - P[..., z, None, :, :]
        drift = (self.phi[others, None, None] * above).sum(axis=-3)[..., None, None, :, :]
        flow = (model.A @ X + model.B @ Y)[..., None, :, :, :]
        corner = drift + he(flow) + 2.0 * self.decay * P[..., :, None, :, :]
        side = P[..., :, None, :, :] - X[..., None, :, :] + self.mu * transpose(flow)
        slack = -self.mu * he(X)[..., None, :, :]
        block = blocks([[corner, side], [transpose(side), slack]])
        size = block.shape[-1]
        found = [
            Constraint("P_r > 0", P, sized=True),
            *([Constraint("P_r >= P_z", above, strict=False)] if others else []),
            Constraint("decrease", -block.reshape(*block.shape[:-4], -1, size, size)),
        ]
        if self.gain_bound is not None:
            # With S the symmetric part of X, X S^-1 X' >= S: so K S K' <= g^2 tr(X) / n.
            square = 0.5 * he(X)
            unit = self.gain_bound * np.trace(values["X"], axis1=-2, axis2=-1)[..., None, None, None] / model.states
            border = unit * np.eye(Y.shape[-2])
            found.append(Constraint("gain bound", blocks([[self.gain_bound * square, transpose(Y)], [Y, border]])))
        return found


def design_dependent(
    model: PolytopicSystem,
    *,
    rates_hold_in_closed_loop: bool,
    decay: float = 0.0,
    mu: Sequence[float] = MU_GRID,
    z: int | None = None,
    gain_bound: float | None = None,
    digits: int = 7,
    settings: SolverSettings | None = None,
) -> Design:
    """The gains whose proof has the largest margin over the searched mu.

    Parameters
    ----------
    rates_hold_in_closed_loop: True says that the model's bounds on the rates do not depend on the input, or cover the
        inputs of the design: otherwise they follow from the gains that are to be found, and the design is circular.
    z: the weight whose rate is eliminated; the fastest one unless given.

    Raises
    ------
    RateError: for a model without bounds on rates, or without the assurance about them.
    ArgumentError: without inputs.
    SolverError: if the solver failed for every mu.
    """
    if not rates_hold_in_closed_loop:
        raise RateError(
            "design D needs bounds on the rates that hold in closed loop: where the input moves the weights they "
            "depend on the gains to be found; use design_quadratic, which needs no rates"
        )
    bounds = model.require_rates("design D")
    if model.B is None:
        raise ArgumentError("model", "a system with inputs", "one without B")
    if not np.equal(model.B, model.B[0]).all():
        raise ArgumentError("B", "the same at every vertex", "different ones", "use design_quadratic, which has pairs")
    finite_number("decay", decay, low=0.0)
    chosen = int(np.argmax(bounds.high)) if z is None else z
    if not 0 <= chosen < model.count:
        raise ArgumentError("z", f"a weight 0..{model.count - 1}", str(z))
    best: Design | None = None
    failures = []
    for value in mu:
        finite_number("mu", value, low=0.0, open_low=True)
        problem = DependentSynthesis(model, bounds.high, chosen, float(value), decay, gain_bound)
        try:
            families = coefficients(problem.unknowns, problem.constraints)
            found = MarginSolver(settings or SolverSettings()).solve(families)
        except SolverError as error:
            failures.append(f"mu {value:g}: {error}")
            continue
        design = _claimed(model, problem, found, digits)
        if best is None or _rank(design.result) > _rank(best.result):
            best = design
    if best is None:
        raise SolverError(f"design D failed for every mu ({'; '.join(failures)})")
    return best


def _claimed(model: PolytopicSystem, problem: DependentSynthesis, found: ConicSolution, digits: int) -> Design:
    values = problem.unknowns.unpack(found.vector)
    if found.margin <= 0.0:
        blank = np.zeros_like(values["Y"])
        reason = f"no parameter-dependent design at mu = {problem.mu:g}: the best margin is {found.margin:.3g}"
        return Design("D", blank, Result(Verdict.UNDECIDED, reason, found.margin), found.status, found.iterations)
    transposed: Any = np.linalg.solve(values["X"].T, np.swapaxes(values["Y"], -1, -2))
    gains = rounded(np.swapaxes(transposed, -1, -2), digits)
    loop = model.closed_loop(gains)
    result = decide(Relaxed(decay=problem.decay, z=problem.z), loop)
    return Design("D", to_float(exact_array(gains)), result, found.status, found.iterations)


def _rank(result: Result) -> tuple[int, float]:
    order = (Verdict.UNDECIDED, Verdict.INFEASIBLE, Verdict.SUPPORTED, Verdict.PROVEN)
    return order.index(result.verdict), result.margin
