"""From a theorem and a model to a verdict with its certificate."""

from dataclasses import dataclass

from robust_core.certificates import Certificate
from robust_core.certificates.dual import prove_infeasible
from robust_core.certificates.primal import check_exact
from robust_core.errors import NotProvenError, ProofFailedError
from robust_core.lmi.conic import ConicSolution
from robust_core.lmi.margin import MarginSolver
from robust_core.theorems.base import Model, Theorem
from robust_core.verdict import Verdict


@dataclass(frozen=True, slots=True)
class Result:
    """A verdict, why, and the certificate where there is one.

    ``margin`` is the solver's best t (of equilibrated inequalities): a hint at how clear the case is, never a verdict.
    """

    verdict: Verdict
    reason: str
    margin: float
    certificate: Certificate | None = None
    iterations: int = 0

    def require(self, *, proven: bool = True) -> Certificate:
        """The certificate of a solution.

        Raises
        ------
        NotProvenError: with the verdict and its reason, if there is none, or none that is proven.
        """
        enough = (Verdict.PROVEN,) if proven else (Verdict.PROVEN, Verdict.SUPPORTED)
        if self.verdict not in enough or self.certificate is None:
            raise NotProvenError(f"{self.verdict.value}: {self.reason}")
        return self.certificate


def decide(theorem: Theorem, model: Model, *, exact: bool = True, solver: MarginSolver | None = None) -> Result:
    """Whether the theorem's inequalities hold for the model.

    Parameters
    ----------
    exact: decide in rational arithmetic; without, the best verdict is "supported".
    solver: kept between calls on models of one shape, it saves their layout.

    Raises
    ------
    RateError: if the theorem needs bounds on the rates and the model has none.
    SolverError: if the solver failed or ran into its limits.
    """
    theorem = theorem.specialised(model)
    found, names = (solver or MarginSolver()).ask(theorem, model)
    if found.margin > 0.0:
        return conclude_feasible(theorem, model, found, names, exact=exact)
    return conclude_infeasible(theorem, model, found, exact=exact)


def conclude_feasible(
    theorem: Theorem, model: Model, found: ConicSolution, names: tuple[str, ...], *, exact: bool
) -> Result:
    """Verdict on a solution that the solver gave, with the margins of the named constraints."""
    margins = dict(zip(names, found.margins, strict=True))
    values = theorem.unknowns(model).unpack(found.vector)
    try:
        if exact:
            check_exact(theorem, model, values)
        elif not min(found.margins) > 0.0:
            raise ProofFailedError(f"the least eigenvalue in floating point is {min(found.margins):.3g}")
    except ProofFailedError as error:
        return Result(Verdict.UNDECIDED, str(error), found.margin, None, found.iterations)
    certificate = Certificate(theorem, model, values, None, margins)
    if not exact:
        verdict, reason = Verdict.SUPPORTED, "the inequalities hold in floating point"
    elif theorem.USES_RATES and not model.rates_proven:
        verdict, reason = Verdict.SUPPORTED, "the inequalities hold exactly, but the bounds on the rates are sampled"
    else:
        verdict, reason = Verdict.PROVEN, "the inequalities hold in exact arithmetic"
    return Result(verdict, reason, found.margin, certificate, found.iterations)


def conclude_infeasible(theorem: Theorem, model: Model, found: ConicSolution, *, exact: bool) -> Result:
    """Verdict where the best margin is not positive."""
    if not exact:
        reason = f"the best margin is {found.margin:.3g}; only exact arithmetic can tell that there is no solution"
        return Result(Verdict.UNDECIDED, reason, found.margin, None, found.iterations)
    try:
        multipliers = prove_infeasible(theorem, model, found.multipliers)
    except ProofFailedError as error:
        reason = f"the best margin is {found.margin:.3g}, and neither a solution nor its absence could be proven"
        return Result(Verdict.UNDECIDED, f"{reason} ({error})", found.margin, None, found.iterations)
    certificate = Certificate(theorem, model, None, multipliers)
    if theorem.USES_RATES and not model.rates_proven:
        reason = "there is no solution at the sampled rates, but their bounds are not proven"
        return Result(Verdict.UNDECIDED, reason, found.margin, certificate, found.iterations)
    reason = "multipliers in exact arithmetic rule out every solution"
    return Result(Verdict.INFEASIBLE, reason, found.margin, certificate, found.iterations)
