"""Coefficients of a theorem's inequalities, got by evaluating its formulas on the unit vectors of the unknowns."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from robust_core.errors import ArgumentError
from robust_core.lmi.constraint import Constraint
from robust_core.lmi.unknowns import Unknowns, Values
from robust_core.rational import Floats

Formulas = Callable[[Values], Sequence[Constraint]]


@dataclass(frozen=True, slots=True)
class Family:
    """One constraint: F(y) = constant + sum_i y_i linear[i], with shapes (K, n, n) and (size, K, n, n)."""

    name: str
    constant: Floats
    linear: Floats
    weight: float
    sized: bool

    def at(self, vector: Floats) -> Floats:
        """F(y)."""
        return np.asarray(self.constant + np.tensordot(vector, self.linear, axes=1))

    def magnitude(self, vector: Floats) -> Floats:
        """Sum of the absolute values of all terms of F(y): what its rounding errors scale with."""
        return np.asarray(np.abs(self.constant) + np.tensordot(np.abs(vector), np.abs(self.linear), axes=1))


def coefficients(unknowns: Unknowns, formulas: Formulas) -> tuple[Family, ...]:
    """The families of an LMI in floats.

    Raises
    ------
    ArgumentError: if a coefficient is not finite: the model's numbers are too large.
    """
    families = []
    for constraint in formulas(unknowns.probes()):
        stack = np.asarray(constraint.matrices, dtype=np.float64)
        if not np.isfinite(stack).all():
            raise ArgumentError(constraint.name, "finite", "an overflow", "scale the model")
        families.append(Family(constraint.name, stack[0], stack[1:] - stack[0], constraint.weight, constraint.sized))
    return tuple(families)
