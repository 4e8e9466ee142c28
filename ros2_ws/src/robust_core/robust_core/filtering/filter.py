"""Filters x_f' = A x_f + B y, z_f = C x_f, (3.1.7), and the error system that one makes with a plant."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from robust_core.checks import finite_array
from robust_core.errors import ArgumentError
from robust_core.lmi.constraint import blocks
from robust_core.models import FilterPlant, PolytopicSystem
from robust_core.theorems.base import Data
from robust_core.theorems.options import MatrixOption, matrix_option, option_array, rounded


@dataclass(frozen=True, slots=True)
class Filter:
    """Exact A (k, k), B (k, y) and C (z, k) as nested texts; build it with :meth:`of`."""

    A: MatrixOption
    B: MatrixOption
    C: MatrixOption

    @staticmethod
    def of(A: Any, B: Any, C: Any, *, digits: int | None = None) -> "Filter":
        """A filter from matrices; with ``digits`` floats are rounded to that many significant digits first.

        >>> Filter.of([[-1]], [["0.5"]], [[1]]).order
        1

        Raises
        ------
        ArgumentError: for matrices that do not fit each other or are not finite.
        """
        if digits is not None:
            A, B, C = (
                rounded(finite_array(name, m, (None, None)), digits) for name, m in zip("ABC", (A, B, C), strict=True)
            )
        size = len(np.asarray(A))
        state = matrix_option("A", A, (size, size))
        return Filter(state, matrix_option("B", B, (size, None)), matrix_option("C", C, (None, size)))

    @property
    def order(self) -> int:
        """Number of states."""
        return len(self.A)

    def matrices(self, *, exact: bool = False) -> tuple[Any, Any, Any]:
        """A, B and C in one kind of numbers."""
        A, B, C = (option_array(option, exact=exact) for option in (self.A, self.B, self.C))
        return A, B, C

    def check(self, plant: FilterPlant) -> None:
        """Raise ArgumentError unless the filter takes the plant's y and gives its z."""
        sizes = plant.sizes
        if len(self.B[0]) != sizes["y"]:
            raise ArgumentError("B", f"with {sizes['y']} columns, one per measurement", f"{len(self.B[0])}")
        if len(self.C) != sizes["z"]:
            raise ArgumentError("C", f"with {sizes['z']} rows, one per estimated signal", f"{len(self.C)}")


def error_matrices(data: Data, filtering: Filter, *, exact: bool) -> tuple[Any, Any, Any, Any]:
    """A~, B~, C~, D~ of the error system (3.1.8) at the vertices, from a plant's arrays."""
    A, B, C = filtering.matrices(exact=exact)
    zero = 0 * (data["A"][..., :, :1] @ A[:1, :])
    state = blocks([[data["A"], zero], [B @ data["E"], A + 0 * zero[..., :1, :1]]])
    drive = blocks([[data["B"]], [B @ data["F"]]])
    output = blocks([[data["C"], -C + 0 * data["C"][..., :1, :1]]])
    return state, drive, output, data["D"]


def error_poles_model(plant: FilterPlant, filtering: Filter) -> PolytopicSystem:
    """The error system without input as a model of its own, for claims about its poles and stability."""
    state, _, _, _ = error_matrices(plant.data(exact=True), filtering, exact=True)
    return PolytopicSystem.of(state, groups=plant.simplices.groups, totals=plant.simplices.totals)
