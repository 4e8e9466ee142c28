"""Corollary 4.1 in scaled variables: the largest Lipschitz constant that Theorem 4.1 admits.

As printed, solvers scatter from 58 to 999 with status "optimal"; with states in units of what they move in one step and
P scaled with the square of D_f they agree on 1000 (erratum 4.3.18). For the sensor the supremum is 1/Ts whatever mass
and stiffness, and its maximiser is blind: it tells how far observers can go, not which one to take.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from robust_core.checks import finite_number
from robust_core.lmi import Constraint, Unknown, Unknowns
from robust_core.lmi.coefficients import coefficients
from robust_core.lmi.constraint import blocks, transpose
from robust_core.lmi.objective import minimise
from robust_core.lmi.settings import SolverSettings
from robust_core.lmi.unknowns import Values
from robust_core.models.lipschitz_plant import LipschitzPlant
from robust_core.observers.observer import FaultObserver
from robust_core.rational import Floats


@dataclass(frozen=True, slots=True)
class Scaled:
    """The plant with states xi = x / units, f in units of ``drive``, y in units of ``output``."""

    A: Floats
    C: Floats
    Df: Floats
    weight: Floats
    drive: float

    @staticmethod
    def of(plant: LipschitzPlant) -> "Scaled":
        """Units that make the numbers of order one."""
        data = plant.data()
        moves = np.hstack([data["A"] - np.eye(plant.states), data["Df"]])
        units = np.abs(moves).max(axis=1)
        units = np.where(units > 0.0, units, 1.0)
        drive = float(np.abs(data["Df"] / units[:, None]).max())
        output = float(np.abs(data["C"] * units).max())
        return Scaled(
            data["A"] * units / units[:, None],
            data["C"] * units / output,
            data["Df"] / units[:, None] / drive,
            np.diag(units**2),
            drive,
        )

    def scaled_map(self, matrix: Floats, plant: LipschitzPlant) -> Floats:
        """A map of states (N, say) in the units of xi."""
        units = np.sqrt(np.diag(self.weight))
        return np.asarray(matrix * units / units[:, None])


def supremum_tau(
    plant: LipschitzPlant,
    *,
    luenberger: bool = False,
    young: float | None = None,
    settings: SolverSettings | None = None,
) -> float:
    """Supremum of tau over all observers, blind ones included; it is not attained in general.

    Parameters
    ----------
    luenberger: only observers with E = 0.
    young: instead of (4.3.16) the coarser pair (1 + e) N'P N - P + tau^2 I < 0, (1 + 1/e) D_f'M'P M D_f < I with this
    e,
        which fits the figures that the thesis gives for itself (e = 1) and for its reference [1] (e = 0.1). Inferred
        from those two figures, and inferior to (4.3.16).

    Raises
    ------
    SolverError: if the solver failed.
    """
    scaled = Scaled.of(plant)
    n, y = plant.states, len(scaled.C)
    if young is not None:
        finite_number("young", young, low=0.0, open_low=True)
    items = [Unknown("t", 1), Unknown("P", n, symmetric=True), Unknown("X", n, y)]
    unknowns = Unknowns(tuple(items if luenberger else [*items, Unknown("E", n, y)]))

    def constraints(values: Values) -> list[Constraint]:
        P, X = values["P"], values["X"]
        E = 0.0 * X if luenberger else values["E"]
        step = P @ scaled.A + E @ scaled.C @ scaled.A - X @ scaled.C
        push = P @ scaled.Df + E @ scaled.C @ scaled.Df
        return _conditions(P, step, push, values["t"], scaled, young)

    return _largest(unknowns, constraints, scaled, settings)


def largest_tau(plant: LipschitzPlant, observer: FaultObserver, *, settings: SolverSettings | None = None) -> float:
    """Supremum of tau for one observer.

    Raises
    ------
    SolverError: if the solver failed, which includes unstable observers.
    """
    scaled, found = Scaled.of(plant), observer.matrices(plant)
    units = np.sqrt(np.diag(scaled.weight))
    N, drive = scaled.scaled_map(found["N"], plant), found["M"] @ plant.data()["Df"] / units[:, None] / scaled.drive
    unknowns = Unknowns((Unknown("t", 1), Unknown("P", plant.states, symmetric=True)))

    def constraints(values: Values) -> list[Constraint]:
        P = values["P"]
        return _conditions(P, P @ N, P @ drive, values["t"], scaled, None)

    return _largest(unknowns, constraints, scaled, settings)


def _conditions(P: Any, step: Any, push: Any, t: Any, scaled: Scaled, young: float | None) -> list[Constraint]:
    P, step, push, t = (part[..., None, :, :] for part in (P, step, push, t))
    start, unit = P - t * scaled.weight, np.eye(push.shape[-1])
    positive = Constraint("P > 0", P)
    if young is None:
        block = blocks(
            [[start, None, transpose(step)], [None, unit, transpose(push)], [step, push, P]],
        )
        return [positive, Constraint("(4.3.17)", block)]
    stretched, pushed = np.sqrt(1.0 + young) * step, np.sqrt(1.0 + 1.0 / young) * push
    return [
        positive,
        Constraint("decrease", blocks([[start, transpose(stretched)], [stretched, P]])),
        Constraint("drive", blocks([[unit, transpose(pushed)], [pushed, P]])),
    ]


def _largest(unknowns: Unknowns, constraints: Any, scaled: Scaled, settings: SolverSettings | None) -> float:
    linear = np.zeros(unknowns.size)
    linear[0] = -1.0
    found = minimise(coefficients(unknowns, constraints), linear=linear, settings=settings)
    return float(np.sqrt(max(found.vector[0], 0.0)) / scaled.drive)
