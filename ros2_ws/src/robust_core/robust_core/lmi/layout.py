"""Layout of the rows that a conic solver sees: one for the size, then those of each constraint's blocks."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Any

import numpy as np

from robust_core.lmi.coefficients import Family
from robust_core.lmi.cones import Cone
from robust_core.rational import Floats


@dataclass(frozen=True, slots=True)
class Rows:
    """``columns`` (unknowns, rows) is the transposed matrix A, ``right`` (rows,) the side b of b - A x in the cones."""

    columns: Floats
    right: Floats


@dataclass(frozen=True)
class Layout:
    """Cones of all constraints for ``size`` unknowns, beside a margin (the last unknown) and a row for the size."""

    cones: tuple[Cone, ...]
    size: int
    with_margin: bool
    with_size: bool

    @staticmethod
    def of(families: Sequence[Family], *, with_margin: bool, with_size: bool) -> "Layout":
        """The layout for families of these shapes."""
        cones = tuple(Cone(family.constant.shape[0], family.constant.shape[1]) for family in families)
        return Layout(cones, families[0].linear.shape[0], with_margin, with_size)

    @cached_property
    def spans(self) -> tuple[slice, ...]:
        """Rows of each constraint."""
        edges = np.cumsum([int(self.with_size), *(cone.rows for cone in self.cones)]).tolist()
        return tuple(slice(start, stop) for start, stop in pairwise(edges))

    @property
    def count(self) -> int:
        """Number of rows."""
        return int(self.spans[-1].stop)

    def rows(self, families: Sequence[Family], normal: Floats | None = None, total: float = 1.0) -> Rows:
        """Rows of F_k(y) - t w_k I, and of ``normal`` . y = ``total``."""
        columns, right = np.zeros((self.size + self.with_margin, self.count)), np.zeros(self.count)
        if self.with_size and normal is not None:
            columns[: self.size, 0], right[0] = normal, total
        for family, cone, span in zip(families, self.cones, self.spans, strict=True):
            columns[: self.size, span] = -cone.to_rows(family.linear)
            right[span] = cone.to_rows(family.constant)
            if self.with_margin:
                identity = np.broadcast_to(np.eye(cone.size), (cone.blocks, cone.size, cone.size))
                columns[-1, span] = family.weight * cone.to_rows(identity)
        return Rows(columns, right)

    def multipliers(self, dual: Floats) -> tuple[Floats, ...]:
        """Matrices (K, n, n) of each constraint from the solver's dual vector."""
        return tuple(cone.multipliers(dual[span]) for cone, span in zip(self.cones, self.spans, strict=True))

    def margins(self, rows: Rows, vector: Floats) -> tuple[float, ...]:
        """Least eigenvalue of each constraint at y (the margin t apart), less what rounding may have added."""
        columns = rows.columns[: self.size]
        values = rows.right - vector @ columns
        sizes = np.abs(rows.right) + np.abs(vector) @ np.abs(columns)
        return tuple(
            cone.least_eigenvalue(values[span]) - 64.0 * 2.0**-52 * cone.size * float(sizes[span].max())
            for cone, span in zip(self.cones, self.spans, strict=True)
        )


def solver_cones(layout: Layout, clarabel: Any) -> list[Any]:
    """Clarabel's cones of a layout."""
    found: list[Any] = [clarabel.ZeroConeT(1)] if layout.with_size else []
    for cone in layout.cones:
        if cone.size == 1:
            found.append(clarabel.NonnegativeConeT(cone.blocks))
        elif cone.size == 2:
            found += [clarabel.SecondOrderConeT(3)] * cone.blocks
        else:
            found += [clarabel.PSDTriangleConeT(cone.size)] * cone.blocks
    return found
