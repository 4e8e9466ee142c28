"""Why printed Theorem 2.4 has no solution: one diagonal entry of (2.3.6), and the exact dual certificate it gives.

Take i = z, a vertex j and a state k that no input reaches, s = (1 + lambda) sum_{r != z} |phi_r|, and the vector
(e_k; w) with w_k = s and w_l = -a_kl for the other states l. On (2.3.6) the gains and all P_kl, l != k, cancel, and
with P_z > I / eps what remains is (2 a_kk + s - sum_l a_kl^2 / s) / eps at least. Where that is positive nothing is a
solution, whatever the gains (erratum 2.3.6). It grows with lambda: ruled out at lambda -> 0, the theorem is ruled out
for all.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from robust_core.analysis import Result
from robust_core.certificates import Certificate
from robust_core.certificates.dual import check_dual
from robust_core.models import PolytopicSystem
from robust_core.rational import Exact, exact_array, rational
from robust_core.stabilisation.theorem_2_4 import PrintedStabilisation
from robust_core.verdict import Verdict


@dataclass(frozen=True, slots=True)
class PositiveEntry:
    """Diagonal entry (state, state) of (2.3.6) for i = z, j = vertex is at least ``value`` (at eps = 1)."""

    z: int
    vertex: int
    state: int
    value: float

    def __str__(self) -> str:
        return (
            f"for i = z = {self.z}, j = {self.vertex} entry ({self.state}, {self.state}) of (2.3.6) is at least "
            f"{self.value:.4g} / eps > 0 whatever P, Q, eps and lambda"
        )


def positive_entry(model: PolytopicSystem, z: int, *, growth: float = 0.0) -> PositiveEntry | None:
    """The largest entry for this z that cannot be negative, at lambda = ``growth``; None where none is found."""
    phi = model.require_rates("theorem 2.4").low
    if model.B is None:
        return None
    speed = float(np.abs(phi).sum() - abs(phi[z])) * (1.0 + float(growth))
    best: PositiveEntry | None = None
    for vertex in range(model.count):
        for k in np.flatnonzero(~model.B[vertex].any(axis=1)).tolist():
            others = float((np.delete(model.A[vertex, k], k) ** 2).sum())
            value = 2.0 * model.A[vertex, k, k] + speed - others / speed if speed > 0.0 else -np.inf
            if value > 0.0 and (best is None or value > best.value):
                best = PositiveEntry(z, vertex, k, float(value))
    return best


def refute_printed(model: PolytopicSystem, *, growth: Any = "1/10", z: int = -1) -> Result:
    """Verdict on printed Theorem 2.4 for one lambda: infeasible with an exact dual certificate, or undecided.

    >>> from robust_core.plants.chua import stabilisation
    >>> result = refute_printed(stabilisation())
    >>> result.verdict.value, result.certificate.verify()
    ('infeasible', {})

    Raises
    ------
    RateError, ArgumentError: for a model without rates or inputs.
    ProofFailedError: never for a certificate made here, unless the arithmetic is at fault.
    """
    theorem = PrintedStabilisation(growth, z).specialised(model)
    factor = 1 + rational(theorem.growth)
    entry = positive_entry(model, theorem.z)
    if entry is None or model.count < 2:
        return Result(Verdict.UNDECIDED, "no diagonal entry of (2.3.6) is positive for this z; ask decide()", 0.0)
    multipliers = _multipliers(model, theorem, entry, factor)
    check_dual(theorem, model, multipliers)
    certificate = Certificate(theorem, model, None, multipliers)
    if not model.rates_proven:
        return Result(Verdict.UNDECIDED, f"{entry}, but the bounds on the rates are not proven", 0.0, certificate)
    return Result(Verdict.INFEASIBLE, str(entry), 0.0, certificate)


def _multipliers(
    model: PolytopicSystem, theorem: PrintedStabilisation, entry: PositiveEntry, factor: Any
) -> dict[str, Exact]:
    """The combination of the module's text: excess / eps is left, which bounds on another P_r contradict."""
    m, n, k = model.count, model.states, entry.state
    data = theorem.data(model, exact=True, bound="low")
    row, speed = data["A"][entry.vertex, k], data["speed"] * factor
    vector = np.concatenate([exact_array(np.eye(n)[k]), -row])
    vector[n + k] = speed
    weight = 2 * (row[k] + speed)
    excess = weight - (vector[n:] * vector[n:]).sum() / speed
    zero = exact_array(np.zeros((n, n)))
    found = {
        "P_z > I / eps": zero[None].copy(),
        "P_r < I / eps": np.repeat(zero[None], m - 1, axis=0),
        "P_r > I / (eps (1 + lambda))": np.repeat(zero[None], m - 1, axis=0),
        "(2.3.6) < 0": exact_array(np.zeros((m * m, 2 * n, 2 * n))),
    }
    found["(2.3.6) < 0"][theorem.z * m + entry.vertex] = np.outer(vector, vector)
    found["P_z > I / eps"][0, k, k] = weight
    share = excess * factor / (factor - 1)
    found["P_r < I / eps"][0, 0, 0] = share
    found["P_r > I / (eps (1 + lambda))"][0, 0, 0] = share / factor
    return found
