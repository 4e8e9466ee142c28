"""One call of the interior-point solver Clarabel on families of LMIs, always on the same sparsity pattern.

min c.y + 1/2 y.Q y - weight of the margin t   subject to   F_k(y) - t w_k I >= 0,   n.y = size.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from robust_core.errors import MissingDependencyError, SolverError, SolverLimitError
from robust_core.lmi.coefficients import Family
from robust_core.lmi.cones import Cone
from robust_core.lmi.settings import SolverSettings
from robust_core.rational import Floats


@dataclass(frozen=True, slots=True)
class ConicSolution:
    """``vector`` y, ``margin`` t (0 where none was asked for), multipliers (K, n, n) of each family, and the effort."""

    vector: Floats
    margin: float
    multipliers: tuple[Floats, ...]
    objective: float
    status: str
    iterations: int

    @property
    def accurate(self) -> bool:
        """Whether the solver reached the tolerance that it was asked for."""
        return self.status == "Solved"


@dataclass(slots=True)
class ConicProblem:
    """Layout of the rows of one shape of problem; keeps the union of the non-zeros met so far as its pattern."""

    cones: tuple[Cone, ...]
    size: int
    with_margin: bool
    with_size: bool
    pattern: NDArray[np.bool_] | None = None
    _indices: NDArray[np.intp] = field(default_factory=lambda: np.empty(0, dtype=np.intp))
    _pointers: NDArray[np.intp] = field(default_factory=lambda: np.empty(0, dtype=np.intp))
    _solver_cones: list[Any] = field(default_factory=list)

    @staticmethod
    def shaped(families: Sequence[Family], *, with_margin: bool, with_size: bool) -> "ConicProblem":
        """A problem for families of these shapes."""
        cones = tuple(Cone(family.constant.shape[0], family.constant.shape[1]) for family in families)
        return ConicProblem(cones, families[0].linear.shape[0], with_margin, with_size)

    def solve(
        self,
        families: Sequence[Family],
        *,
        settings: SolverSettings,
        normal: Floats | None = None,
        total: float = 1.0,
        linear: Floats | None = None,
        quadratic: Floats | None = None,
    ) -> ConicSolution:
        """Solve; ``normal`` and ``total`` fix the size, ``linear`` (size,) and ``quadratic`` (size, size) the cost.

        Raises
        ------
        SolverLimitError: if time or iterations ran out.
        SolverError: if the solver gave up for another reason; the text says which.
        """
        clarabel, sparse = _packages()
        columns, right = self._columns(families, normal, total)
        self._grow(columns != 0.0, clarabel)
        matrix = sparse.csc_matrix(
            (columns[self.pattern], self._indices, self._pointers), shape=(columns.shape[1], columns.shape[0])
        )
        cost = np.zeros(columns.shape[0])
        if linear is not None:
            cost[: self.size] = linear
        if self.with_margin:
            cost[-1] = -1.0
        hessian = np.zeros((cost.size, cost.size))
        if quadratic is not None:
            hessian[: self.size, : self.size] = np.triu(quadratic)
        options = _options(clarabel, settings)
        found = clarabel.DefaultSolver(
            sparse.csc_matrix(hessian), cost, matrix, right, self._solver_cones, options
        ).solve()
        return self._solution(found)

    def _columns(self, families: Sequence[Family], normal: Floats | None, total: float) -> tuple[Floats, Floats]:
        """The constraint matrix transposed, and the right-hand side; rows s = right - A x must lie in the cones."""
        count = self.size + self.with_margin
        rows = int(self.with_size) + sum(cone.rows for cone in self.cones)
        columns, right = np.zeros((count, rows)), np.zeros(rows)
        start = int(self.with_size)
        if self.with_size and normal is not None:
            columns[: self.size, 0], right[0] = normal, total
        for family, cone in zip(families, self.cones, strict=True):
            stop = start + cone.rows
            columns[: self.size, start:stop] = -cone.to_rows(family.linear)
            right[start:stop] = cone.to_rows(family.constant)
            if self.with_margin:
                identity = np.broadcast_to(np.eye(cone.size), (cone.blocks, cone.size, cone.size))
                columns[-1, start:stop] = family.weight * cone.to_rows(identity)
            start = stop
        return columns, right

    def _grow(self, present: NDArray[np.bool_], clarabel: Any) -> None:
        if self.pattern is None:
            self.pattern = present
            self._solver_cones = [clarabel.ZeroConeT(1)] if self.with_size else []
            for cone in self.cones:
                if cone.size == 1:
                    self._solver_cones.append(clarabel.NonnegativeConeT(cone.blocks))
                elif cone.size == 2:
                    self._solver_cones += [clarabel.SecondOrderConeT(3)] * cone.blocks
                else:
                    self._solver_cones += [clarabel.PSDTriangleConeT(cone.size)] * cone.blocks
        elif not (present & ~self.pattern).any():
            return
        else:
            self.pattern = self.pattern | present
        self._indices = np.nonzero(self.pattern)[1]
        self._pointers = np.concatenate([[0], np.cumsum(self.pattern.sum(axis=1))])

    def _solution(self, found: Any) -> ConicSolution:
        status = str(found.status)
        if status in ("MaxTime", "MaxIterations"):
            raise SolverLimitError(f"the solver stopped at its limit ({status}); allow more, or scale the model")
        if status not in ("Solved", "AlmostSolved", "InsufficientProgress"):
            raise SolverError(f"the solver ended with {status}")
        x, z = np.array(found.x), np.array(found.z)
        if not (np.isfinite(x).all() and np.isfinite(z).all()):
            raise SolverError("the solver returned numbers that are not finite")
        multipliers, start = [], int(self.with_size)
        for cone in self.cones:
            multipliers.append(cone.multipliers(z[start : start + cone.rows]))
            start += cone.rows
        margin = float(x[-1]) if self.with_margin else 0.0
        return ConicSolution(
            x[: self.size], margin, tuple(multipliers), float(found.obj_val), status, int(found.iterations)
        )


def _packages() -> tuple[Any, Any]:
    try:
        import clarabel
        from scipy import sparse
    except ImportError as error:
        raise MissingDependencyError(
            f"LMIs are solved with clarabel and scipy, and {error.name} is not installed; certificates are checked "
            "without them"
        ) from error
    return clarabel, sparse


def _options(clarabel: Any, settings: SolverSettings) -> Any:
    options = clarabel.DefaultSettings()
    options.verbose = False
    options.max_threads = 1
    options.presolve_enable = False
    options.chordal_decomposition_enable = False
    options.time_limit = settings.time_limit_s
    options.max_iter = settings.iterations
    options.tol_gap_abs = options.tol_gap_rel = options.tol_feas = settings.tolerance
    return options
