"""Fault-detection observers in closed form, for two states of which the first is measured.

E = (rho - 1, (nu - A_22) / A_12) and X = M A e_1 give N = [0, rho A_12; 0, nu]: the pole nu is chosen, and rho > 0
keeps the residual alive. The admissible Lipschitz constant is (1 - |nu|) / |D_f|; a slow pole makes faults show most.
"""

from dataclasses import dataclass

import numpy as np

from robust_core.analysis import Result, decide
from robust_core.checks import finite_number
from robust_core.errors import ArgumentError
from robust_core.models.lipschitz_plant import LipschitzPlant
from robust_core.observers.observer import FaultObserver
from robust_core.observers.theorem_4_1 import LipschitzObserver
from robust_core.rational import rational

SMALLEST_SHARE = 1e-9  # of the supremum; no design comes near it, its pole would lie at 1 - 1e-9


@dataclass(frozen=True, slots=True)
class ObserverDesign:
    """The observer, the Lipschitz constant that was asked for, and the verdict on it."""

    observer: FaultObserver
    tau: float
    pole: float
    result: Result


def admissible_pole(plant: LipschitzPlant, tau: float) -> float:
    """The largest pole nu >= 0 that Theorem 4.1 admits for tau; its supremum is tau = (1 - nu) / |D_f|.

    Raises
    ------
    ArgumentError: for a tau of 1 / |D_f| or more, which no pole admits.
    """
    _check(plant)
    reach = abs(float(plant.data()["Df"][1, 0]))
    finite_number("tau", tau, low=0.0)
    pole = 1.0 - tau * reach
    if pole <= 0.0:
        raise ArgumentError(
            "tau", f"below {1.0 / reach:g}, the supremum over all observers", f"{tau:g}", "sample faster or move less"
        )
    return pole


def design_observer(
    plant: LipschitzPlant, tau: float, *, pole: float | None = None, rho: float = 1.0, reserve: float = 1e-3
) -> ObserverDesign:
    """The closed-form observer with the slowest admissible pole, and the proof that tau is admissible.

    Parameters
    ----------
    pole: nu, if not the slowest admissible one less ``reserve`` (relative to 1 - nu, and at most 1 - reserve).
    rho: share of the measurement that the residual keeps, in (0, 1].

    Raises
    ------
    ArgumentError: for plants of another form, or numbers out of range.
    """
    limit = admissible_pole(plant, tau)
    slowest = min(1.0 - (1.0 - limit) * (1.0 + reserve), 1.0 - reserve)
    chosen = slowest if pole is None else pole
    finite_number("pole", chosen, low=-1.0, high=1.0, open_low=True)
    finite_number("rho", rho, low=0.0, high=1.0, open_low=True)
    A = plant.exact["A"]
    nu, kept = rational(float(chosen)), rational(rho)
    E = np.array([[kept - 1], [(nu - A[1, 1]) / A[0, 1]]], dtype=object)
    M = np.array([[kept, rational(0)], [E[1, 0], rational(1)]], dtype=object)
    observer = FaultObserver.of(E, M @ A[:, :1])
    result = decide(LipschitzObserver(observer, repr(_provable(plant, tau))), plant)
    return ObserverDesign(observer, float(tau), float(chosen), result)


def _provable(plant: LipschitzPlant, tau: float) -> float:
    """``tau``, or a larger constant, which implies it, where ``tau`` is too small beside the model for a solver."""
    smallest = SMALLEST_SHARE / abs(float(plant.data()["Df"][1, 0]))
    return float(tau) if tau == 0.0 else max(float(tau), smallest)


def _check(plant: LipschitzPlant) -> None:
    data = plant.exact
    fits = plant.states == 2 and data["C"].shape == (1, 2) and data["Df"].shape == (2, 1)
    if not fits or not (
        data["C"][0, 0] == 1 and data["C"][0, 1] == 0 and data["Df"][0, 0] == 0 and data["A"][0, 1] != 0
    ):
        raise ArgumentError(
            "plant",
            "two states, the first measured, with D_f on the second",
            "another one",
            "use supremum_tau and LMIs",
        )
