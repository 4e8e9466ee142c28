"""Design of terminal weights and sets for discrete polytopic models.

With X = P^-1 and Y = K X the descent is [X, (A_i X + B_i Y)', X Q^1/2, Y'R^1/2; *, X; *, *, I; *, *, *, I] > 0, and the
trace of P in units of Q is the least. The gain is rounded, P kept with a reserve, and both are proven on their own.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from robust_core.analysis import Result
from robust_core.certificates import Certificate
from robust_core.certificates.primal import check_exact, check_float
from robust_core.checks import finite_array, finite_number, symmetric
from robust_core.errors import ArgumentError, ProofFailedError, SolverError
from robust_core.lmi import Constraint, Unknown, Unknowns
from robust_core.lmi.coefficients import coefficients
from robust_core.lmi.constraint import blocks, transpose
from robust_core.lmi.objective import minimise
from robust_core.lmi.settings import SolverSettings
from robust_core.lmi.unknowns import Values
from robust_core.models import PolytopicSystem
from robust_core.rational import Floats, exact_array, to_float
from robust_core.terminal.theorem import TerminalIngredient
from robust_core.theorems.options import matrix_option, rounded
from robust_core.verdict import Verdict

PASSES = 3
"""Attempts at a proof, each measured in the weight that the last one found."""


@dataclass(frozen=True, slots=True)
class TerminalDesign:
    """Weight P (n, n), gain K (r, n), level c of the set {x'P x <= c}, and the ``result`` that says what is proven."""

    P: Floats
    K: Floats
    level: float
    result: Result

    def contains(self, states: Floats) -> Any:
        """Whether states (..., n) are in the terminal set."""
        return np.einsum("...i,ij,...j->...", states, self.P, states) <= self.level


def design_terminal(
    model: PolytopicSystem,
    Q: Any,
    R: Any,
    *,
    state_rows: Any,
    input_rows: Any,
    bounds: Any,
    digits: int = 7,
    reserve: float = 1e-4,
    settings: SolverSettings | None = None,
) -> TerminalDesign:
    """The least weight whose descent pays the stage cost x'Q x + u'R u, and the largest set of it within limits.

    Parameters
    ----------
    state_rows, input_rows, bounds: limits |C x + D u| <= b, row by row: (k, n), (k, r), (k,).
    reserve: relative distance that is kept from where nothing is strict.

    Raises
    ------
    ArgumentError: for shapes that do not fit, weights that are not positive definite, or bounds that are not positive.
    SolverError: if the solver failed, which includes models that no such gain stabilises.
    """
    if model.B is None:
        raise ArgumentError("model", "a system with inputs", "one without B")
    n, r = model.states, model.B.shape[2]
    Q, R = symmetric("Q", Q, n), symmetric("R", R, r)
    for name, matrix in (("Q", Q), ("R", R)):
        if np.linalg.eigvalsh(matrix).min() <= 0.0:
            raise ArgumentError(name, "positive definite", str(matrix.tolist()))
    C, D = finite_array("state_rows", state_rows, (None, n)), finite_array("input_rows", input_rows, (None, r))
    b = finite_array("bounds", bounds, (len(C),))
    if len(D) != len(C) or (b <= 0.0).any():
        raise ArgumentError("bounds", "positive, one per row", str(b.tolist()))
    finite_number("reserve", reserve, low=0.0, high=0.5, open_low=True)
    limits = (C, D, b)
    unit: Floats = np.linalg.cholesky(np.linalg.inv(Q))
    for attempt in range(1, PASSES + 1):
        try:
            X, Y = _solve(model, Q * (1.0 + reserve), R * (1.0 + reserve), unit, settings)
            design = _claimed(model, X, Y, Q, R, limits, digits, reserve)
        except np.linalg.LinAlgError as error:
            raise SolverError("the weight grows without bound: no gain stabilises all vertices") from error
        if design.result.verdict is Verdict.PROVEN or attempt == PASSES:
            break
        # Measured in the weight that was found, the weight is near the identity: well scaled.
        unit = np.asarray(np.linalg.cholesky(0.5 * (X + X.T)), dtype=np.float64)
    return design


def _claimed(
    model: PolytopicSystem,
    X: Floats,
    Y: Floats,
    Q: Floats,
    R: Floats,
    limits: tuple[Floats, Floats, Floats],
    digits: int,
    reserve: float,
) -> TerminalDesign:
    """Rounded gain and weight, the largest level within the limits, and the proof."""
    C, D, b = limits
    n, r = model.states, len(R)
    K = rounded(np.linalg.solve(X, Y.T).T, digits)
    P = to_float(exact_array(rounded(np.linalg.inv(X), 12)))
    P = 0.5 * (P + P.T)
    gain = to_float(exact_array(K))
    rows = C + D @ gain
    reach = np.einsum("ki,ij,kj->k", rows, np.linalg.inv(P), rows)
    level = float((b**2 / np.maximum(reach, 1e-300)).min()) * (1.0 - reserve)
    exact_rows = exact_array(C) + exact_array(D) @ exact_array(K)
    claim = TerminalIngredient(
        matrix_option("gain", K, (r, n)),
        matrix_option("Q", Q, (n, n)),
        matrix_option("R", R, (r, r)),
        matrix_option("rows", exact_rows, (None, n)),
        matrix_option("bounds", b, (None,)),
    )
    values = {"P": P, "w": np.array([[1.0 / level]]), "s": np.ones((1, 1))}
    return TerminalDesign(P, gain, level, _proven(claim.specialised(model), model, values))


def _solve(
    model: PolytopicSystem, Q: Floats, R: Floats, unit: Floats, settings: SolverSettings | None
) -> tuple[Floats, Floats]:
    """X and Y, found for the states in the given units."""
    assert model.B is not None
    n, r = model.states, len(R)
    A, B = np.linalg.solve(unit, model.A @ unit), np.linalg.solve(unit, model.B)
    root, state_root = np.linalg.cholesky(R).T, np.linalg.cholesky(Q).T @ unit
    unknowns = Unknowns((Unknown("X", n, symmetric=True), Unknown("Y", r, n), Unknown("P", n, symmetric=True)))

    def constraints(values: Values) -> list[Constraint]:
        X, Y = values["X"][..., None, :, :], values["Y"][..., None, :, :]
        after, paid = A @ X + B @ Y, root @ Y
        lower = blocks([[after], [state_root @ X], [paid]])
        size = 2 * n + r
        corner = np.zeros((*X.shape[:-2], size, size))
        corner[..., :n, :n] = X
        corner[..., n:, n:] = np.eye(n + r)
        block = blocks([[X, transpose(lower)], [lower, corner]])
        inverse = blocks([[values["P"], np.eye(n)], [np.eye(n), values["X"]]])
        return [Constraint("descent", block), Constraint("P >= X^-1", inverse[..., None, :, :])]

    blank = {item.name: np.zeros(item.index.shape) for item in unknowns.items}
    # The trace of P measured in Q, whatever the units here; entries off the diagonal count twice.
    price = np.linalg.solve(unit, np.linalg.solve(unit, np.linalg.inv(Q)).T)
    linear = np.asarray(unknowns.pack({**blank, "P": price + price.T - np.diag(np.diag(price))}))
    found = unknowns.unpack(minimise(coefficients(unknowns, constraints), linear=linear, settings=settings).vector)
    return unit @ found["X"] @ unit.T, found["Y"] @ unit.T


def _proven(claim: TerminalIngredient, model: PolytopicSystem, values: dict[str, Floats]) -> Result:
    try:
        margins = check_float(claim, model, values)
        check_exact(claim, model, values)
    except ProofFailedError as error:
        return Result(Verdict.UNDECIDED, str(error), 0.0)
    certificate = Certificate(claim, model, values, None, margins)
    return Result(Verdict.PROVEN, "the inequalities hold in exact arithmetic", min(margins.values()), certificate)
