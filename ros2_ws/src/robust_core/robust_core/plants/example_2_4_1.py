"""Example 2.4.1: two states, four vertices in two pairs, parameters alpha and beta.

Entry (1, 2) of (2.4.1) is -4, not the printed -1 (erratum 2.4.1): only then do the vertices mix to it.
"""

from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np

from robust_core.models.polytope import PolytopicSystem
from robust_core.rational import Exact, exact_array, rational

if TYPE_CHECKING:
    from robust_core.symbolic import StateDependentModel

GROUPS = ((0, 1), (2, 3))
"""sigma_1 + sigma_2 = sigma_3 + sigma_4 = 1/2."""


def vertices(alpha: Any, beta: Any) -> Exact:
    """Exact A_1...A_4, (4, 2, 2)."""
    a, b = rational(alpha), rational(beta)

    def q(text: str) -> Any:
        return rational(Fraction(text))

    return exact_array(
        [
            [[q("-5"), q("-4")], [q("-1"), a]],
            [[q("-4"), q("-4")], [q("0.6") * b - q("0.4"), q("0.6") * a - q("0.8")]],
            [[q("-3"), q("-4")], [q("0.4") * b - q("0.6"), q("0.4") * a - q("1.2")]],
            [[q("-2"), q("-4")], [b, q("-2")]],
        ]
    )


def system(alpha: Any, beta: Any, rates: Any = None) -> PolytopicSystem:
    """The model at one point of the map.

    >>> system(-14, 100).A[3].tolist()
    [[-2.0, -4.0], [100.0, -2.0]]
    """
    return PolytopicSystem.of(vertices(alpha, beta), groups=GROUPS, rates=rates)


def symbolic(half_width: float, *, upper_right: float = -4.0) -> "StateDependentModel":
    """(2.4.1) as formulas over |x1|, |x2| <= half_width, with alpha and beta as parameters.

    ``upper_right`` is entry (1, 2) of (2.4.1); with the printed -1 the vertices do not mix to it.
    """
    import casadi

    from robust_core.symbolic import StateDependentModel

    x, p = casadi.SX.sym("x", 2), casadi.SX.sym("p", 2)
    a, b, s = p[0], p[1], casadi.sin(x[0]) + casadi.sin(x[1])
    matrix = casadi.blockcat(
        [
            [-3.5 + 0.25 * s, upper_right],
            [0.5 * (b - 1) + 0.15 * (b + 1) * s, 0.5 * (a - 2) - 0.1 * (a + 2) * s],
        ]
    )
    quarter = [0.25 * (1 - casadi.sin(x[1])), 0.25 * (1 + casadi.sin(x[1]))]
    quarter += [0.25 * (1 - casadi.sin(x[0])), 0.25 * (1 + casadi.sin(x[0]))]
    return StateDependentModel.of(
        states=x,
        low=[-half_width] * 2,
        high=[half_width] * 2,
        matrix=matrix,
        weights=casadi.vertcat(*quarter),
        vertices=[
            casadi.blockcat([[-5, -4], [-1, a]]),
            casadi.blockcat([[-4, -4], [0.6 * b - 0.4, 0.6 * a - 0.8]]),
            casadi.blockcat([[-3, -4], [0.4 * b - 0.6, 0.4 * a - 1.2]]),
            casadi.blockcat([[-2, -4], [b, -2]]),
        ],
        groups=GROUPS,
        parameters=p,
    )


@dataclass(frozen=True)
class Family:
    """Models for points (alpha, beta), with rates enclosed over |x1|, |x2| <= half_width rounded up."""

    half_width: float

    def __call__(self, points: Any) -> list[PolytopicSystem]:
        """One model per row of ``points`` (N, 2)."""
        rows = np.asarray(points, dtype=np.float64)
        bounds = symbolic(float(np.nextafter(self.half_width, np.inf))).rate_map().bounds(rows)
        return [system(alpha, beta, rates) for (alpha, beta), rates in zip(rows.tolist(), bounds, strict=True)]


def grid(steps: int) -> Any:
    """(steps^2, 2) points of [-20, 0] x [100, 200], ends included."""
    alpha, beta = np.linspace(-20.0, 0.0, steps), np.linspace(100.0, 200.0, steps)
    return np.stack([axis.ravel() for axis in np.meshgrid(alpha, beta, indexing="ij")], axis=1)
