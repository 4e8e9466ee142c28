"""Theorem 4.1: an observer's error converges for every nonlinearity with a Lipschitz constant, and faults show.

The bound is unstructured: |f(a) - f(b)| <= tau |a - b| in the 2-norm of the states as they are, a mixture of units in
general; with ``units`` it is tau |diag(units)^-1 (a - b)|.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from robust_core.errors import ArgumentError
from robust_core.lmi import Constraint, Unknown, Unknowns
from robust_core.lmi.constraint import blocks, transpose
from robust_core.lmi.unknowns import Values
from robust_core.observers.observer import BlindObserverError, FaultObserver
from robust_core.rational import exact_array, rational, to_float
from robust_core.theorems.base import Data, Theorem, exact_option
from robust_core.theorems.options import MatrixOption, matrix_option, option_array


@dataclass(frozen=True)
class LipschitzObserver(Theorem):
    """(4.3.16) for given N and M, scaled by an unknown s > 0, with a residual that is not blind."""

    NAME = "4.1"
    PROVES = "convergence of the observer for the Lipschitz constant, with a residual that faults move"
    observer: FaultObserver
    tau: Any
    units: MatrixOption = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "tau", exact_option("tau", self.tau))
        if rational(self.tau) < 0:
            raise ArgumentError("tau", "at least 0", self.tau)
        if any(rational(unit) <= 0 for unit in self.units):
            raise ArgumentError("units", "positive", repr(self.units))

    def specialised(self, model: Any) -> "LipschitzObserver":
        """Itself; BlindObserverError where the residual does not depend on the fault."""
        self.observer.matrices(model)
        if self.units and len(self.units) != model.states:
            raise ArgumentError("units", f"{model.states} of them, one per state", str(len(self.units)))
        if self.observer.is_blind(model):
            raise BlindObserverError(
                "E",
                "such that the residual depends on the fault",
                "an observer with C (zI - N)^-1 M D = 0",
                "fix E_1 = rho - 1 with rho > 0, as design_observer does",
            )
        return self

    def data(self, model: Any, *, exact: bool = False, bound: str = "high") -> Data:
        """N, M D_f and tau^2 W."""
        data = dict(super().data(model, exact=exact, bound=bound))
        found = self.observer.matrices(model, exact=exact)
        squares = [rational(unit) ** -2 for unit in self.units] or [rational(1)] * model.states
        weight = exact_array(np.eye(model.states))
        for k, square in enumerate(squares):
            weight[k, k] = square * rational(self.tau) ** 2
        unit = exact_array(np.eye(data["Df"].shape[1]))
        data |= {"N": found["N"], "drive": found["M"] @ data["Df"]}
        data["weight"], data["unit"] = (weight, unit) if exact else (to_float(weight), to_float(unit))
        return data

    def unknowns(self, model: Any) -> Unknowns:
        """P (n, n) and s."""
        return Unknowns((Unknown("P", model.states, symmetric=True), Unknown("s", 1)))

    def constraints(self, data: Data, values: Values) -> Sequence[Constraint]:
        """P > 0 and (4.3.16)."""
        P, s = values["P"][..., None, :, :], values["s"][..., None, :, :]
        next_state, next_drive = P @ data["N"], P @ data["drive"]
        block = blocks(
            [
                [P - s * data["weight"], None, transpose(next_state)],
                [None, s * data["unit"], transpose(next_drive)],
                [next_state, next_drive, P],
            ]
        )
        return (Constraint("P > 0", P, sized=True), Constraint("(4.3.16) < 0", block))

    def to_json(self) -> dict[str, Any]:
        """Name and options as plain data."""
        gains = {name: [list(row) for row in getattr(self.observer, name)] for name in "EX"}
        return {"name": self.NAME, "options": {"observer": gains, "tau": self.tau, "units": list(self.units)}}

    @classmethod
    def options_from_json(cls, options: Mapping[str, Any]) -> dict[str, Any]:
        """Keyword arguments from plain options."""
        observer = FaultObserver.of(options["observer"]["E"], options["observer"]["X"])
        return {"observer": observer, "tau": options["tau"], "units": tuple(options["units"])}


def units_option(units: Any) -> MatrixOption:
    """Units of the states as an option of the theorem."""
    return matrix_option("units", units, (None,))


def tau_of(theorem: LipschitzObserver) -> float:
    """The Lipschitz constant as a float."""
    return float(option_array((theorem.tau,), exact=False)[0])
