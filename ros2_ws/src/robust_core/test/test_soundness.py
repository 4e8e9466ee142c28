"""Verdicts on random systems against another solver and against simulation."""

import cvxopt
import numpy as np
import pytest
from cvxopt import solvers

from robust_core.analysis import decide
from robust_core.lmi.coefficients import coefficients
from robust_core.lmi.margin import size_of
from robust_core.lmi.scaling import equilibrate
from robust_core.samples import random_systems
from robust_core.theorems import CommonLyapunov, ParameterDependent, Relaxed, Slack, TensorCorners, TensorProduct
from robust_core.verdict import Verdict

CLEAR = 1e-6


def peer_margin(theorem, model) -> float:
    """Best margin by CVXOPT; NaN where it gives up."""
    theorem = theorem.specialised(model)
    data = theorem.data(model)
    families, _ = equilibrate(coefficients(theorem.unknowns(model), lambda probes: theorem.constraints(data, probes)))
    normal, total = size_of(families)
    matrices, sides = [], []
    for family in families:
        n = family.constant.shape[-1]
        for k in range(len(family.constant)):
            columns = [-one.ravel() for one in family.linear[:, k]] + [family.weight * np.eye(n).ravel()]
            matrices.append(cvxopt.matrix(np.stack(columns, axis=1)))
            sides.append(cvxopt.matrix(np.zeros((n, n))))
    cost = cvxopt.matrix(np.append(np.zeros(len(normal)), -1.0))
    equal = cvxopt.matrix(np.append(normal, 0.0)[None])
    try:
        found = solvers.sdp(
            cost, Gs=matrices, hs=sides, A=equal, b=cvxopt.matrix([total]), options={"show_progress": False}
        )
    except (ArithmeticError, ValueError):
        return float("nan")
    return float(found["x"][len(normal)]) if found["status"] == "optimal" else float("nan")


@pytest.mark.parametrize(
    ("theorem", "sizes"),
    [
        (CommonLyapunov(), {"states": (2, 5), "vertices": (2, 5)}),
        (ParameterDependent(), {"states": (2, 3), "vertices": (2, 3), "rates": True}),
        (Relaxed(), {"states": (2, 3), "vertices": (2, 3), "rates": True}),
        (Slack(), {"states": (2, 3), "vertices": (2, 3), "rates": True}),
        (TensorCorners(), {"states": (2, 3), "vertices": (2, 3), "rates": True}),
        (TensorProduct(), {"states": (2, 3), "vertices": (2, 3), "rates": True}),
    ],
    ids=lambda value: getattr(value, "NAME", ""),
)
def test_no_verdict_is_contradicted_by_another_solver(theorem, sizes) -> None:
    agreed = 0
    for sample in random_systems(11, 24, **sizes):
        verdict, margin = decide(theorem, sample.model).verdict, peer_margin(theorem, sample.model)
        assert not (verdict is Verdict.PROVEN and margin < -CLEAR), sample.made
        assert not (verdict is Verdict.INFEASIBLE and margin > CLEAR), sample.made
        agreed += (verdict is Verdict.PROVEN and margin > CLEAR) or (verdict is Verdict.INFEASIBLE and margin < -CLEAR)
    assert agreed >= 10


def test_lyapunov_functions_fall_along_every_simulated_motion() -> None:
    rng = np.random.default_rng(2)
    for sample in random_systems(12, 30):
        result = decide(CommonLyapunov(), sample.model)
        if result.verdict is not Verdict.PROVEN:
            continue
        P = result.require().vertex_matrices()[0]
        A = sample.model.A / np.abs(sample.model.A).max()
        x = rng.normal(size=sample.model.states)
        for _ in range(50):
            mixed = np.tensordot(rng.dirichlet(np.full(sample.model.count, 0.3)), A, axes=1)
            moved = x + 1e-3 * mixed @ (x + 5e-4 * mixed @ x)
            assert moved @ P @ moved < x @ P @ x
            x = moved / np.linalg.norm(moved)


def test_samples_are_the_same_for_the_same_seed() -> None:
    first, second = ([one.model.digest for one in random_systems(3, 6)] for _ in range(2))
    assert first == second
