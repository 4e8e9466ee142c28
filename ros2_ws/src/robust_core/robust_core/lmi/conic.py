"""One call of the interior-point solver Clarabel, always on the same sparsity pattern.

min c.y + 1/2 y.Q y - weight of the margin t   subject to   F_k(y) - t w_k I >= 0,   n.y = size.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from robust_core.errors import MissingDependencyError, SolverError, SolverLimitError
from robust_core.lmi.coefficients import Family
from robust_core.lmi.layout import Layout, Rows, solver_cones
from robust_core.lmi.settings import SolverSettings
from robust_core.rational import Floats


@dataclass(frozen=True, slots=True)
class ConicSolution:
    """``vector`` y, ``margin`` t (0 where none was asked for), multipliers (K, n, n) of each family, and the effort.

    ``margins`` are the least eigenvalues of each family at y, in the units of the equilibrated problem, less what
    rounding may have added: where they are positive, y is a solution in floating point.
    """

    vector: Floats
    margin: float
    multipliers: tuple[Floats, ...]
    objective: float
    status: str
    iterations: int
    margins: tuple[float, ...] = ()

    @property
    def accurate(self) -> bool:
        """Whether the solver reached the tolerance that it was asked for."""
        return self.status == "Solved"


@dataclass(slots=True)
class ConicProblem:
    """Problems of one layout; keeps the union of the non-zeros met so far as their pattern."""

    layout: Layout
    _pattern: NDArray[np.bool_] | None = None
    _matrix: Any = None
    _zero: Any = None
    _cones: list[Any] = field(default_factory=list)

    @staticmethod
    def shaped(families: Sequence[Family], *, with_margin: bool, with_size: bool) -> "ConicProblem":
        """A problem for families of these shapes."""
        return ConicProblem(Layout.of(families, with_margin=with_margin, with_size=with_size))

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
        rows = self.layout.rows(families, normal, total)
        return self.solve_rows(rows, settings=settings, linear=linear, quadratic=quadratic)

    def solve_rows(
        self,
        rows: Rows,
        *,
        settings: SolverSettings,
        linear: Floats | None = None,
        quadratic: Floats | None = None,
    ) -> ConicSolution:
        """The same from rows that are already laid out."""
        clarabel, sparse = _packages()
        self._grow(rows.columns != 0.0, clarabel, sparse)
        count, size = len(rows.columns), self.layout.size
        self._matrix.data = rows.columns[self._pattern]
        cost = np.zeros(count)
        if linear is not None:
            cost[:size] = linear
        if self.layout.with_margin:
            cost[-1] = -1.0
        hessian = self._zero
        if quadratic is not None:
            full = np.zeros((count, count))
            full[:size, :size] = np.triu(quadratic)
            hessian = sparse.csc_matrix(full)
        found = clarabel.DefaultSolver(
            hessian, cost, self._matrix, rows.right, self._cones, _options(clarabel, settings)
        ).solve()
        return self._solution(rows, found)

    def _grow(self, present: NDArray[np.bool_], clarabel: Any, sparse: Any) -> None:
        if self._pattern is None:
            self._pattern = present
            self._cones = solver_cones(self.layout, clarabel)
            self._zero = sparse.csc_matrix((len(present), len(present)))
        elif not (present & ~self._pattern).any():
            return
        else:
            self._pattern = self._pattern | present
        indices, pointers = np.nonzero(self._pattern)[1], np.concatenate([[0], np.cumsum(self._pattern.sum(axis=1))])
        shape = (self.layout.count, len(present))
        self._matrix = sparse.csc_matrix((np.ones(len(indices)), indices, pointers), shape=shape)

    def _solution(self, rows: Rows, found: Any) -> ConicSolution:
        status = str(found.status)
        if status in ("MaxTime", "MaxIterations"):
            raise SolverLimitError(f"the solver stopped at its limit ({status}); allow more, or scale the model")
        if status not in ("Solved", "AlmostSolved", "InsufficientProgress"):
            raise SolverError(f"the solver ended with {status}")
        x, z = np.array(found.x), np.array(found.z)
        if not (np.isfinite(x).all() and np.isfinite(z).all()):
            raise SolverError("the solver returned numbers that are not finite")
        size = self.layout.size
        return ConicSolution(
            vector=x[:size],
            margin=float(x[-1]) if self.layout.with_margin else 0.0,
            multipliers=self.layout.multipliers(z),
            objective=float(found.obj_val),
            status=status,
            iterations=int(found.iterations),
            margins=self.layout.margins(rows, x[:size]),
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
