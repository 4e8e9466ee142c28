"""The best figure of a given filter, and a certificate of it."""

from dataclasses import dataclass

import numpy as np

from robust_core.analysis import Result, decide
from robust_core.errors import SolverError
from robust_core.filtering.filter import Filter
from robust_core.filtering.index import DissipativeIndex
from robust_core.filtering.theorem_3_1 import DissipativeFilter
from robust_core.lmi import Constraint, Unknown, Unknowns
from robust_core.lmi.coefficients import coefficients
from robust_core.lmi.objective import minimise
from robust_core.lmi.settings import SolverSettings
from robust_core.lmi.unknowns import Values
from robust_core.models import FilterPlant
from robust_core.theorems.regions import Region
from robust_core.verdict import Verdict

RESERVES = (1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2)
"""Relative distances from the optimum at which a proof is tried: at the optimum itself nothing is strict."""


@dataclass(frozen=True, slots=True)
class FilterAnalysis:
    """``figure``: gamma or tau that the certificate proves; ``optimum``: what the solver says it could be at best."""

    figure: float
    optimum: float
    result: Result


def analyse_filter(
    plant: FilterPlant,
    filtering: Filter,
    index: DissipativeIndex,
    *,
    region: Region | None = None,
    settings: SolverSettings | None = None,
) -> FilterAnalysis:
    """The smallest level that Theorem 3.1 proves for a filter, a hair above the optimum.

    Raises
    ------
    ArgumentError, ImpossibleIndexError: where filter, index and plant do not fit.
    SolverError: if the solver failed, which includes filters whose error no level bounds.
    """
    filtering.check(plant)
    index.check(plant)
    floor = DissipativeFilter(filtering, index, "0", region)
    data = floor.data(plant)
    unknowns = Unknowns((floor.unknowns(plant).items[0], Unknown("level", 1)))

    def constraints(values: Values) -> list[Constraint]:
        at_zero = floor.constraints(data, {"P": values["P"], "s": np.ones_like(values["level"])})
        return [_raised(constraint, values, plant) for constraint in at_zero if constraint.name != "s > 0"]

    blank = {item.name: np.zeros(item.index.shape) for item in unknowns.items}
    linear = np.asarray(unknowns.pack({**blank, "level": np.ones((1, 1))}))
    found = minimise(coefficients(unknowns, constraints), linear=linear, settings=settings)
    level = float(unknowns.unpack(found.vector)["level"][0, 0])
    return certify_level(plant, filtering, index, level, region=region)


def certify_level(
    plant: FilterPlant, filtering: Filter, index: DissipativeIndex, level: float, *, region: Region | None = None
) -> FilterAnalysis:
    """Prove the smallest level above ``level`` that can be proven; the figure is that level's."""
    result = Result(Verdict.UNDECIDED, "no proof was tried", 0.0)
    scale = max(abs(level), 1e-9)
    for reserve in RESERVES:
        raised = level + reserve * scale
        claim = DissipativeFilter(filtering, index, f"{raised:.12e}", region)
        try:
            result = decide(claim, plant)
        except SolverError as error:
            result = Result(Verdict.UNDECIDED, str(error), 0.0)
            continue
        if result.verdict is Verdict.PROVEN:
            return FilterAnalysis(claim.figure, index.figure_at(level), result)
    return FilterAnalysis(float("nan"), index.figure_at(level), result)


def _raised(constraint: Constraint, values: Values, plant: FilterPlant) -> Constraint:
    """The constraint of level 0 with the unknown level added to Psi3."""
    if not constraint.name.startswith("dissipation"):
        return constraint
    w = plant.sizes["w"]
    matrices = constraint.matrices.copy()
    matrices[..., -w:, -w:] += values["level"][..., None, :, :] * np.eye(w)
    return Constraint(constraint.name, matrices)
