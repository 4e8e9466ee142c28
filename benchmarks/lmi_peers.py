"""Theorem 2.3 and common Lyapunov functions as cvxpy users write them, and CVXOPT on the same coefficients."""

from collections.abc import Sequence
from typing import Any

import cvxopt
import cvxpy
import numpy as np
from cvxopt import solvers

from robust_core.lmi.coefficients import Family
from robust_core.lmi.margin import size_of

solvers.options.update({"show_progress": False, "abstol": 1e-9, "reltol": 1e-9, "feastol": 1e-9})


def relaxed_problem(A: Sequence[Any], phi: Any, z: int, states: int) -> tuple[Any, Any]:
    """Theorem 2.3 in cvxpy, from numbers or from parameters; returns the problem and its margin."""
    count = len(A)
    P = [cvxpy.Variable((states, states), symmetric=True) for _ in range(count)]
    t, one = cvxpy.Variable(), np.eye(states)
    others = [r for r in range(count) if r != z]
    rates = sum(phi[r] * (P[r] - P[z]) for r in others)
    constraints = [sum(cvxpy.trace(p) for p in P) == states * count]
    constraints += [p >> t * one for p in P] + [P[r] >> P[z] for r in others]
    for i in range(count):
        for j in range(i, count):
            product = A[j].T @ P[i] + P[i] @ A[j] + A[i].T @ P[j] + P[j] @ A[i]
            constraints.append(0.5 * product + rates << -t * one)
    return cvxpy.Problem(cvxpy.Maximize(t), constraints), t


def rebuilt(A: Any, phi: Any, z: int, solver: str = "CLARABEL") -> float:
    """Best margin of theorem 2.3 with a problem made for the occasion."""
    problem, t = relaxed_problem(list(A), phi, z, A.shape[1])
    problem.solve(solver=solver)
    return float(t.value)


class Parametrised:
    """Best margins of theorem 2.3 with one problem whose matrices and rates are cvxpy parameters (DPP)."""

    def __init__(self, count: int, states: int, z: int) -> None:
        self.A = [cvxpy.Parameter((states, states)) for _ in range(count)]
        self.phi = cvxpy.Parameter(count, nonneg=True)
        self.problem, self.t = relaxed_problem(self.A, self.phi, z, states)

    def solve(self, A: Any, phi: Any) -> float:
        """Best margin for other numbers."""
        for parameter, value in zip(self.A, A, strict=True):
            parameter.value = value
        self.phi.value = phi
        self.problem.solve(solver="CLARABEL")
        return float(self.t.value)


def common_margin(A: Any, solver: str = "CVXOPT") -> float:
    """Best margin of theorem 2.1 by cvxpy."""
    n = A.shape[1]
    P, t = cvxpy.Variable((n, n), symmetric=True), cvxpy.Variable()
    constraints = [cvxpy.trace(P) == n, P >> t * np.eye(n)]
    constraints += [P @ a + a.T @ P << -t * np.eye(n) for a in A]
    problem = cvxpy.Problem(cvxpy.Maximize(t), constraints)
    try:
        problem.solve(solver=solver)
    except cvxpy.error.SolverError:
        return float("nan")
    return float(t.value)


def cvxopt_margin(families: Sequence[Family]) -> float:
    """Best margin of homogeneous LMIs by CVXOPT, called directly."""
    normal, total = size_of(families)
    size = len(normal)
    blocks, sides = [], []
    for family in families:
        n = family.constant.shape[-1]
        for k in range(family.constant.shape[0]):
            columns = [-family.linear[i, k].ravel() for i in range(size)] + [family.weight * np.eye(n).ravel()]
            blocks.append(cvxopt.matrix(np.stack(columns, axis=1)))
            sides.append(cvxopt.matrix(np.zeros((n, n))))
    cost = cvxopt.matrix(np.append(np.zeros(size), -1.0))
    equal = cvxopt.matrix(np.append(normal, 0.0)[None])
    try:
        found = solvers.sdp(cost, Gs=blocks, hs=sides, A=equal, b=cvxopt.matrix([total]))
    except (ArithmeticError, ValueError):
        return float("nan")
    if found["x"] is None or found["status"] != "optimal":
        return float("nan")
    return float(found["x"][size])
