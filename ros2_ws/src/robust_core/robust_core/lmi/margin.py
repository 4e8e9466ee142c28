"""The largest margin of homogeneous LMIs: max t with F_k(y) >= t w_k I and fixed trace.

Always strictly feasible and bounded; the sign of t separates feasible from infeasible, and its multipliers are the dual
certificate where it is negative. Bounding P <= I instead would make t exactly 0 wherever the LMIs are infeasible, and
P >> 0, LMI << 0 without a size is "solved" everywhere by P = 0.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from robust_core.errors import ArgumentError
from robust_core.lmi.coefficients import Family, coefficients
from robust_core.lmi.conic import ConicProblem, ConicSolution
from robust_core.lmi.layout import Layout
from robust_core.lmi.scaling import equilibrate
from robust_core.lmi.settings import SolverSettings
from robust_core.lmi.template import Template
from robust_core.rational import Floats


@dataclass(slots=True)
class MarginSolver:
    """Solves many LMIs of one shape; keeps their layout."""

    settings: SolverSettings = field(default_factory=SolverSettings)
    _problem: ConicProblem | None = None
    _asked: set[Any] = field(default_factory=set)
    _templates: dict[Any, tuple[Template, ConicProblem] | None] = field(default_factory=dict)

    def ask(self, theorem: Any, model: Any) -> tuple[ConicSolution, tuple[str, ...]]:
        """The best margin of a theorem's LMIs for a model, and the names of its constraints.

        Raises
        ------
        SolverError: if the solver failed.
        """
        data = theorem.data(model)
        key = (theorem, *(np.shape(data[name]) for name in theorem.AFFINE if name in data))
        # A template costs as much as some tens of solves: it is made when a theorem is asked again.
        if key in self._asked and key not in self._templates:
            self._templates[key] = self._template(theorem, model, data)
        self._asked.add(key)
        kept = self._templates.get(key)
        rows = None if kept is None else kept[0].rows(data)
        if kept is None or rows is None:
            families = coefficients(theorem.unknowns(model), lambda probes: theorem.constraints(data, probes))
            return self.solve(families), tuple(family.name for family in families)
        template, problem = kept
        found = problem.solve_rows(rows, settings=self.settings)
        return replace(found, multipliers=_without_size(template.sized, found, template.total)), template.names

    @staticmethod
    def _template(theorem: Any, model: Any, data: Any) -> tuple[Template, ConicProblem] | None:
        keys = [key for key in theorem.AFFINE if key in data]
        if not keys:
            return None
        unknowns = theorem.unknowns(model)
        template = Template.of(
            keys, data, lambda some: coefficients(unknowns, lambda probes: theorem.constraints(some, probes))
        )
        return None if template is None else (template, ConicProblem(template.layout))

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
        layout = Layout.of(scaled, with_margin=True, with_size=True)
        if self._problem is None or self._problem.layout != layout:
            self._problem = ConicProblem(layout)
        found = self._problem.solve(scaled, settings=self.settings, normal=normal, total=total)
        multipliers = _without_size([family.sized for family in scaled], found, total)
        if scaling is None:
            return replace(found, multipliers=multipliers)
        return replace(found, vector=found.vector * scaling.units, multipliers=scaling.multipliers(multipliers))


def _without_size(sized: Sequence[bool], found: ConicSolution, total: float) -> tuple[Floats, ...]:
    """Multipliers of the LMIs alone: where t < 0, the sized blocks take sum <Z_k, F_k[i]> = t / total * normal[i]."""
    share = max(-found.margin, 0.0) / total
    return tuple(
        multipliers + share * np.eye(multipliers.shape[-1]) if one else multipliers
        for one, multipliers in zip(sized, found.multipliers, strict=True)
    )


def size_of(families: Sequence[Family]) -> tuple[Floats, float]:
    """The functional that fixes the size (sum of traces of the sized families), and its value (their dimension)."""
    sized = [family for family in families if family.sized]
    if not sized:
        raise ArgumentError("families", "with one marked as sized", "none")
    normal = sum(np.trace(family.linear, axis1=2, axis2=3).sum(axis=1) for family in sized)
    total = sum(family.constant.shape[0] * family.constant.shape[1] for family in sized)
    return np.asarray(normal, dtype=np.float64), float(total)
