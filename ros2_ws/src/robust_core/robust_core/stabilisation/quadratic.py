"""Designs Q and S: vertex gains from one quadratic Lyapunov function, with or without limits.

With X = P^-1 and Y_j = K_j X: A_i X + B_i Y_j + (.)' + 2 decay X < 0 (erratum 2.3.6), on pairs i <= j where the B_i
differ; [X, Y_j'; Y_j, u^2] >= 0 keeps |u| <= u_max in {x'X^-1 x <= 1}, c X c' <= b^2 keeps it in the box, and
[1, v'; v, X] >= 0 puts the start v inside: design S. The gains are rounded, then proven on their own.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from robust_core.analysis import decide
from robust_core.errors import ArgumentError
from robust_core.lmi import Constraint, Unknown, Unknowns, he
from robust_core.lmi.coefficients import coefficients
from robust_core.lmi.constraint import blocks, transpose
from robust_core.lmi.determinant import determinant_root
from robust_core.lmi.objective import minimise
from robust_core.lmi.settings import SolverSettings
from robust_core.lmi.unknowns import Values
from robust_core.models import PolytopicSystem
from robust_core.rational import Floats, to_float
from robust_core.stabilisation.closed_loop import ClosedLoop
from robust_core.stabilisation.design import Design, conclude
from robust_core.stabilisation.request import Request
from robust_core.theorems.d_stability import kronecker
from robust_core.theorems.options import rounded
from robust_core.theorems.regions import Region


@dataclass(frozen=True, slots=True)
class QuadraticSynthesis:
    """The inequalities of designs Q and S in floats."""

    model: PolytopicSystem
    request: Request
    limits: dict[str, Floats]

    @property
    def unknowns(self) -> Unknowns:
        """X (n, n), Y (m, r, n), and what a large set needs."""
        n, r = self.model.states, _inputs(self.model)
        found = [Unknown("X", n, symmetric=True), Unknown("Y", r, n, count=self.model.count)]
        if self.request.objective == "large set":
            found += [
                Unknown("Z", n, symmetric=True),
                Unknown("root", 1),
                Unknown("steps", 1, count=max(determinant_root(n).steps, 1)),
            ]
        return Unknowns(tuple(found))

    def constraints(self, values: Values) -> list[Constraint]:
        """All inequalities, those without a size of their own made so by X >= I."""
        X, Y, n = values["X"][..., None, :, :], values["Y"], self.model.states
        flow = self._flow(X, Y)
        decay = self.request.decay * (1.0 + self.request.reserve) + self.request.reserve * _slowness(self.model)
        found = [Constraint("decay", -he(flow) - 2.0 * decay * X)]
        if self.request.region is not None:
            L, M = _floats(self.request.region)
            inside = kronecker(L, X) + kronecker(M, flow) + kronecker(M.T, transpose(flow))
            found.append(Constraint("region", -inside))
        keep = 1.0 - self.request.reserve
        if "input_limit" in self.limits:
            rows = Y.reshape(*Y.shape[:-3], -1, 1, n)
            bounds = np.tile((keep * self.limits["input_limit"]) ** 2, self.model.count)[:, None, None]
            found.append(Constraint("inputs", _bordered(X, rows, bounds)))
        if "box" in self.limits:
            rows = self.limits["box"][:, None, :]
            found.append(
                Constraint("box", (keep * self.limits["box_limit"][:, None, None]) ** 2 - rows @ X @ transpose(rows))
            )
        if "start" in self.limits:
            points = self.limits["start"][:, None, :] * (1.0 + self.request.reserve)
            found.append(
                Constraint(
                    "start", _bordered(X, np.broadcast_to(points, (*X.shape[:-3], *points.shape)), np.ones((1, 1, 1)))
                )
            )
        if not self.limits:
            found.append(Constraint("X > I", X - np.eye(n)))
        elif self.request.objective == "large set":
            found += determinant_root(n).constraints(values["X"], values["Z"], values["root"], values["steps"])
        return found

    def objective(self) -> tuple[Floats | None, Floats | None]:
        """Linear and quadratic part of what is minimised."""
        unknowns = self.unknowns
        blank = {item.name: np.zeros(item.index.shape) for item in unknowns.items}
        if self.request.objective == "large set":
            return -np.asarray(unknowns.pack({**blank, "root": np.ones((1, 1))})), None
        if self.request.objective == "small set":
            return np.asarray(unknowns.pack({**blank, "X": np.eye(self.model.states)})), None
        return None, np.diag(np.asarray(unknowns.pack({**blank, "Y": np.full(blank["Y"].shape, 2.0)})))

    def _flow(self, X: Any, Y: Any) -> Any:
        A, B = self.model.A, self.model.B
        assert B is not None
        if np.equal(B, B[0]).all():
            return A @ X + B @ Y
        first, second = np.triu_indices(len(A))
        one = A[first] @ X + B[first] @ Y[..., second, :, :]
        return 0.5 * (one + A[second] @ X + B[second] @ Y[..., first, :, :])


def _inputs(model: PolytopicSystem) -> int:
    if model.B is None:
        raise ArgumentError("model", "a system with inputs", "one without B")
    return int(model.B.shape[2])


def _slowness(model: PolytopicSystem) -> float:
    """A rate (1/s) that is small for this model: where the reserve of a design without decay comes from."""
    return 0.1 * float(np.abs(np.linalg.eigvals(model.A)).min(axis=1).max())


def _bordered(X: Any, rows: Any, corners: Any) -> Any:
    """[X, c'; c, b] for rows c (..., k, 1, n) and corners b (k, 1, 1)."""
    return blocks([[X + 0.0 * corners, transpose(rows)], [rows, corners + 0.0 * rows[..., :1]]])


def _floats(region: Region) -> tuple[Floats, Floats]:
    L, M = region.matrices
    return to_float(L), to_float(M)


def design_quadratic(
    model: PolytopicSystem, request: Request | None = None, *, settings: SolverSettings | None = None
) -> Design:
    """Vertex gains that meet the request, with the certificate of the claim that they do.

    Raises
    ------
    ArgumentError: for a model without inputs or limits of other shapes.
    SolverError: if the solver failed, which includes requests that nothing meets.
    """
    request = request or Request()
    limits = request.limits(model.states, _inputs(model))
    problem = QuadraticSynthesis(model, request, limits)
    linear, quadratic = problem.objective()
    found = minimise(
        coefficients(problem.unknowns, problem.constraints), linear=linear, quadratic=quadratic, settings=settings
    )
    values = problem.unknowns.unpack(found.vector)
    gains = rounded(np.linalg.solve(values["X"], np.swapaxes(values["Y"], -1, -2)).swapaxes(-1, -2), request.digits)
    claim = ClosedLoop.of(gains, decay=request.decay, region=request.region, **limits)
    return conclude("S" if limits else "Q", claim, decide(claim, model), found)
