"""Chua's oscillator as formulas (CasADi): weights, vertices and rates derived, not copied."""

from typing import Any

import casadi

from robust_core.plants.chua import BOX, DIODE
from robust_core.symbolic import StateDependentModel, Term, derive

_QUADRATIC = BOX * BOX


def stabilisation() -> StateDependentModel:
    """x' = A(x2) x + B u for |x1|, |x2| <= 6 V; the current is in the weights nowhere, so its box is of no account."""
    x = casadi.SX.sym("x", 3)
    return derive(
        states=x,
        low=[-BOX, -BOX, -BOX],
        high=[BOX, BOX, BOX],
        terms=[Term(-x[1], -BOX, BOX), Term(x[1] * x[1], 0.0, _QUADRATIC)],
        matrix=lambda minus_v, square: _matrix(DIODE[1] * minus_v, square),
        input_matrix=lambda *_: casadi.SX([[-1.0], [0.0], [0.0]]),
    )


def synchronisation() -> StateDependentModel:
    """e' = A(x2, y2) e + B u for the error e = y - x of a follower y, all four voltages within 6 V."""
    error, v = casadi.SX.sym("e", 3), casadi.SX.sym("v", 4)
    x2, y2 = v[1], v[3]
    motion = casadi.vertcat(0, _voltage_rate(v[0], x2), 0, _voltage_rate(v[2], y2))
    return derive(
        states=error,
        variables=v,
        motion=motion,
        low=[-BOX] * 4,
        high=[BOX] * 4,
        terms=[Term(-(x2 + y2), -2.0 * BOX, 2.0 * BOX), Term(x2 * x2 + x2 * y2 + y2 * y2, 0.0, 3.0 * _QUADRATIC)],
        matrix=lambda minus_sum, square: _matrix(DIODE[1] * minus_sum, square),
        input_matrix=lambda *_: casadi.SX([[-1.0], [0.0], [0.0]]),
    )


def _matrix(linear: Any, square: Any) -> Any:
    """A with the diode's slope -l1 - l2 v - l3 v^2, where ``linear`` = -l2 v."""
    a22 = -1.0 / (0.7 * 0.1) - 10.0 * (DIODE[0] - linear + DIODE[2] * square)
    return casadi.blockcat([[-1 / 0.7, 1 / 0.7, 1], [10 / 0.7, a22, 0], [-1 / 0.07, 0, -0.01 / 0.07]])


def _voltage_rate(x1: Any, x2: Any) -> Any:
    return 10.0 * ((x1 - x2) / 0.7 - (DIODE[0] * x2 + DIODE[1] * x2 * x2 + DIODE[2] * x2 * x2 * x2))
