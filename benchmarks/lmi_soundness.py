"""No verdict on random systems is contradicted: by their construction, by CVXOPT, by cvxpy or by simulation."""

import copy
from typing import Any

import numpy as np
from lmi_peers import common_margin, cvxopt_margin

from robust_core.analysis import Result, decide
from robust_core.certificates.files import from_content, to_content
from robust_core.errors import RobustCoreError
from robust_core.lmi.coefficients import coefficients
from robust_core.lmi.scaling import equilibrate
from robust_core.models import PolytopicSystem
from robust_core.samples import Sample, random_systems
from robust_core.theorems import (
    CommonLyapunov,
    ParameterDependent,
    Relaxed,
    Slack,
    TensorCorners,
    TensorProduct,
    Theorem,
)
from robust_core.verdict import Verdict

CLEAR = 1e-6
"""A peer's margin (of equilibrated inequalities with unit trace per dimension) that is no rounding error."""

TALLY = (
    "systems", "proven", "infeasible", "undecided", "contradicted",
    "peer_agrees", "peer_silent", "corrupted", "accepted",
)  # fmt: skip
WITH_RATES = (ParameterDependent(), Relaxed(), Slack(), TensorCorners(), TensorProduct())


def soundness(seed: int, count: int) -> dict[str, float]:
    """Verdicts on ``count`` systems: four fifths of theorem 2.1 with n 2-6 and 2-8 vertices, the rest of the others."""
    tally = dict.fromkeys(TALLY, 0.0)
    rng = np.random.default_rng(seed + 1)
    rated = count // 5
    cases: list[tuple[Theorem, Sample]] = [(CommonLyapunov(), one) for one in random_systems(seed, count - rated)]
    small = random_systems(seed + 2, rated, states=(2, 3), vertices=(2, 4), rates=True)
    cases += [(WITH_RATES[number % len(WITH_RATES)], one) for number, one in enumerate(small)]
    for number, (theorem, sample) in enumerate(cases):
        result = decide(theorem, sample.model)
        tally["systems"] += 1
        key = {Verdict.PROVEN: "proven", Verdict.INFEASIBLE: "infeasible"}.get(result.verdict, "undecided")
        tally[key] += 1
        contradictions(theorem, sample, result, rng, tally, thorough=number % 50 == 0)
        if result.certificate is not None and number % 5 == 0:
            tally["corrupted"] += 1
            tally["accepted"] += accepted_when_corrupted(result, rng)
    return tally


def contradictions(
    theorem: Theorem,
    sample: Sample,
    result: Result,
    rng: np.random.Generator,
    tally: dict[str, float],
    *,
    thorough: bool,
) -> None:
    """Count the witnesses that contradict a verdict, agree with it, or do not say."""
    claim = {Verdict.PROVEN: True, Verdict.INFEASIBLE: False}.get(result.verdict)
    if claim is None:
        return
    # Theorem 2.2 may fail where a common P exists: its rates count even if all P_r are equal.
    known = None if sample.feasible and isinstance(theorem, ParameterDependent) else sample.feasible
    tally["contradicted"] += known is not None and known != claim
    special = theorem.specialised(sample.model)
    data = special.data(sample.model)
    families = coefficients(special.unknowns(sample.model), lambda probes: special.constraints(data, probes))
    margins = [cvxopt_margin(equilibrate(families)[0])]
    if thorough and isinstance(theorem, CommonLyapunov):
        margins.append(common_margin(sample.model.A / np.abs(sample.model.A).max()))
    for margin in margins:
        agrees = margin > CLEAR if claim else margin < -CLEAR
        contradicts = margin < -CLEAR if claim else margin > CLEAR
        tally["peer_agrees" if agrees else "contradicted" if contradicts else "peer_silent"] += 1
    if thorough and claim and isinstance(theorem, CommonLyapunov) and result.certificate is not None:
        tally["contradicted"] += not decreases(sample.model, result.certificate.vertex_matrices()[0], rng)


def decreases(model: PolytopicSystem, P: Any, rng: np.random.Generator) -> bool:
    """Whether x'Px falls at every step of a simulation under weights that jump at random."""
    A = model.A / np.abs(model.A).max()
    x = rng.normal(size=model.states)
    for _ in range(200):
        mixed = np.tensordot(rng.dirichlet(np.full(model.count, 0.3)), A, axes=1)
        before, step = x @ P @ x, 1e-3
        k1 = mixed @ x
        k2 = mixed @ (x + 0.5 * step * k1)
        k3 = mixed @ (x + 0.5 * step * k2)
        x = x + step / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + mixed @ (x + step * k3))
        if not x @ P @ x < before:
            return False
        x = x / np.linalg.norm(x)
    return True


def accepted_when_corrupted(result: Result, rng: np.random.Generator) -> int:
    """Change one digit somewhere in the certificate's text; 1 if it still loads and proves."""
    if result.certificate is None:
        return 0
    content = copy.deepcopy(to_content(result.certificate))
    part = content["values"] or content["multipliers"]
    texts = [content["model"]["A"]["values"], *(entry["values"] for entry in part.values())]
    text = texts[int(rng.integers(len(texts)))]
    place = int(rng.integers(len(text)))
    digits = [k for k, letter in enumerate(text[place]) if letter.isdigit()]
    where = digits[int(rng.integers(len(digits)))]
    new = str((int(text[place][where]) + int(rng.integers(1, 10))) % 10)
    text[place] = text[place][:where] + new + text[place][where + 1 :]
    try:
        from_content(content).verify("exact")
    except RobustCoreError:
        return 0
    return 1
