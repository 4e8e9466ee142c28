"""The largest margin of homogeneous LMIs: max t with F_k(y) >= t w_k I and fixed trace.

Always strictly feasible and bounded; the sign of t separates feasible from infeasible, and its multipliers are the dual
certificate where it is negative. Bounding P <= I instead would make t exactly 0 wherever the LMIs are infeasible, and
P >> 0, LMI << 0 without a size is "solved" everywhere by P = 0.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from robust_core.errors import ArgumentError
from robust_core.lmi.coefficients import Family
from robust_core.lmi.conic import ConicProblem, ConicSolution
from robust_core.lmi.scaling import equilibrate
from robust_core.lmi.settings import SolverSettings
from robust_core.rational import Floats


@dataclass(slots=True)
class MarginSolver:
    """Solves many LMIs of one shape; keeps their layout."""

    settings: SolverSettings = field(default_factory=SolverSettings)
    _problem: ConicProblem | None = None

    def solve(self, families: Sequence[Family]) -> ConicSolution:
        """The best margin, in units of the equilibrated blocks; vector and multipliers are those of ``families``.

        Raises
        ------
        ArgumentError: if no family is marked as sized, or one has a constant part.
        SolverError: if the solver failed.
        """
        if any(family.constant.any() for family in families):
            raise ArgumentError("families", "homogeneous", "a constant part", "use minimise() for affine LMIs")
        scaled, scaling = equilibrate(families)
        normal, total = size_of(scaled)
        problem = self._problem
        shapes = tuple(family.constant.shape[:2] for family in families)
        if problem is None or problem.size != normal.size or shapes != tuple((c.blocks, c.size) for c in problem.cones):
            problem = self._problem = ConicProblem.shaped(scaled, with_margin=True, with_size=True)
        found = problem.solve(scaled, settings=self.settings, normal=normal, total=total)
        multipliers = _without_size(scaled, found, total)
        if scaling is None:
            return replace(found, multipliers=multipliers)
        return replace(found, vector=found.vector * scaling.units, multipliers=scaling.multipliers(multipliers))


def _without_size(families: Sequence[Family], found: ConicSolution, total: float) -> tuple[Floats, ...]:
    """Multipliers of the LMIs alone: where t < 0, the sized blocks take sum <Z_k, F_k[i]> = t / total * normal[i]."""
    share = max(-found.margin, 0.0) / total
    return tuple(
        multipliers + share * np.eye(multipliers.shape[-1]) if family.sized else multipliers
        for family, multipliers in zip(families, found.multipliers, strict=True)
    )


def size_of(families: Sequence[Family]) -> tuple[Floats, float]:
    """The functional that fixes the size (sum of traces of the sized families), and its value (their dimension)."""
    sized = [family for family in families if family.sized]
    if not sized:
        raise ArgumentError("families", "with one marked as sized", "none")
    normal = sum(np.trace(family.linear, axis1=2, axis2=3).sum(axis=1) for family in sized)
    total = sum(family.constant.shape[0] * family.constant.shape[1] for family in sized)
    return np.asarray(normal, dtype=np.float64), float(total)
