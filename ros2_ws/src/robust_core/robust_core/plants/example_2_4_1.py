"""Example 2.4.1: two states, four vertices in two pairs, parameters alpha and beta.

Entry (1, 2) of (2.4.1) is -4, not the printed -1 (erratum 2.4.1): only then do the vertices mix to it.
"""

from fractions import Fraction
from typing import Any

from robust_core.models.polytope import PolytopicSystem
from robust_core.rational import Exact, exact_array, rational

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
