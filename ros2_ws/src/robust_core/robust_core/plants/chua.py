"""Chua's oscillator of section 2.4.2: stabilisation at the origin, and synchronisation of two of them.

States: the voltages of both capacitors (V) and the current of the inductor (A); input: the current of a source (A).
All numbers are exact. The weights come in two pairs that each sum to 1/2.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np

from robust_core.checks import finite_number
from robust_core.models import PolytopicSystem, RateBounds
from robust_core.rational import Floats

BOX = 6.0
"""The model holds for both voltages within +-6 V."""

GROUPS = ((0, 1), (2, 3))
INPUT = (("-1",), ("0",), ("0",))

DIODE = (-8.0 / 7.0, -0.01, 2.0 / 7.0)
"""Current of the diode: l1 v + l2 v^2 + l3 v^3."""

PHI = (30.15, 29.85, 120.6, 3.2227136586424354)
"""Largest rates of the weights over the box, the same for both problems (1/s). The thesis prints 3.1862 for the last,
a local maximum (erratum 2.4.2); it is the maximum of a cubic and rounded up here."""

PRINTED_PHI4 = 3.1862
"""The last rate as the thesis prints it: too small."""

STABILISATION_A22 = ("-58/35", "-142/35", "-20/7", "-1460/7")
SYNCHRONISATION_A22 = ("-16/35", "-184/35", "-20/7", "-620")

PRINTED_STABILISATION_GAINS = (
    (("-1.5095", "63.0684", "-10.2284"),),
    (("-1.5078", "62.9542", "-10.2285"),),
    (("-1.5087", "63.0113", "-10.2284"),),
    (("-1.1253", "53.2145", "-10.2387"),),
)
PRINTED_SYNCHRONISATION_GAINS = (
    (("3.7240", "248.2100", "-7.7791"),),
    (("3.7549", "249.8049", "-7.7783"),),
    (("3.7394", "249.0075", "-7.7787"),),
    (("7.9557", "454.1497", "-7.6821"),),
)


def stabilisation(rates: RateBounds | Sequence[float] | None = PHI) -> PolytopicSystem:
    """The oscillator itself, x' = sum_r sigma_r(x2) A_r x + B u."""
    return _system(STABILISATION_A22, rates)


def synchronisation(rates: RateBounds | Sequence[float] | None = PHI) -> PolytopicSystem:
    """The error e of a second oscillator behind the first, whose nonlinearity depends on both voltages x2."""
    return _system(SYNCHRONISATION_A22, rates)


def _system(damping: Sequence[str], rates: Any) -> PolytopicSystem:
    matrices = [[["-10/7", "10/7", 1], ["100/7", entry, 0], ["-100/7", 0, "-1/7"]] for entry in damping]
    return PolytopicSystem.of(
        np.array(matrices, dtype=object), np.array(INPUT, dtype=object), groups=GROUPS, rates=rates
    )


def derivative(state: Floats, current: Any = 0.0) -> Floats:
    """x' of the circuit, for states (..., 3)."""
    x1, x2, x3 = state[..., 0], state[..., 1], state[..., 2]
    diode = x2 * (DIODE[0] + x2 * (DIODE[1] + x2 * DIODE[2]))
    exchange = (x1 - x2) / 0.7
    return np.stack([x3 - exchange - current, 10.0 * (exchange - diode), -(x1 + 0.01 * x3) / 0.07], axis=-1)


def stabilisation_weights(x2: Any) -> Floats:
    """sigma(x2), shape (..., 4)."""
    x2 = np.asarray(x2, dtype=np.float64)
    quadratic = x2 * x2 / 72.0
    return np.stack([0.25 + x2 / 24.0, 0.25 - x2 / 24.0, 0.5 - quadratic, quadratic], axis=-1)


def synchronisation_weights(x2: Any, follower_x2: Any) -> Floats:
    """sigma of both voltages, shape (..., 4)."""
    a, b = np.asarray(x2, dtype=np.float64), np.asarray(follower_x2, dtype=np.float64)
    quadratic = (a * a + a * b + b * b) / 216.0
    linear = (a + b) / 48.0
    return np.stack([0.25 + linear, 0.25 - linear, 0.5 - quadratic, quadratic], axis=-1)


def stabilising_current(gains: Floats, limit: float = np.inf) -> Any:
    """u(x) = sum_r sigma_r(x2) K_r x within +-limit, for gains (4, 1, 3); a function of states (..., 3)."""
    bound = finite_number("limit", min(limit, 1e300), low=0.0, open_low=True)

    def current(state: Floats) -> Floats:
        gain = stabilisation_weights(state[..., 1]) @ gains[:, 0, :]
        return np.asarray(np.clip((gain * state).sum(axis=-1), -bound, bound))

    return current


def synchronising_current(gains: Floats, limit: float = np.inf) -> Any:
    """u of the follower within +-limit; a function of the states of both, (..., 6), the leader's first."""
    bound = finite_number("limit", min(limit, 1e300), low=0.0, open_low=True)

    def current(states: Floats) -> Floats:
        gain = synchronisation_weights(states[..., 1], states[..., 4]) @ gains[:, 0, :]
        error = states[..., 3:] - states[..., :3]
        return np.asarray(np.clip((gain * error).sum(axis=-1), -bound, bound))

    return current
