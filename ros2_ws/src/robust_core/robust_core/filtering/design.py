"""Design of filters by Theorem 3.2, proven by Theorem 3.1 after rounding."""

from dataclasses import dataclass

import numpy as np

from robust_core.checks import finite_number
from robust_core.errors import ArgumentError, SolverError
from robust_core.filtering.analyse import FilterAnalysis, analyse_filter
from robust_core.filtering.filter import Filter
from robust_core.filtering.index import DissipativeIndex
from robust_core.filtering.theorem_3_2 import Synthesis
from robust_core.lmi.coefficients import coefficients
from robust_core.lmi.objective import minimise
from robust_core.lmi.settings import SolverSettings
from robust_core.models import FilterPlant
from robust_core.rational import to_float
from robust_core.theorems.regions import Region


@dataclass(frozen=True, slots=True)
class FilterDesign:
    """``filtering``: the rounded filter; ``optimum``: figure of Theorem 3.2; ``analysis``: what is proven of it.

    ``analysis`` is None where it was not asked for; nothing is claimed then.
    """

    filtering: Filter
    optimum: float
    analysis: FilterAnalysis | None
    status: str
    iterations: int


def design_filter(
    plant: FilterPlant,
    index: DissipativeIndex,
    *,
    order: int | None = None,
    region: Region | None = None,
    fastest_pole: float | None = None,
    digits: int = 9,
    certify: bool = True,
    settings: SolverSettings | None = None,
) -> FilterDesign:
    """The filter with the best figure, of the plant's order or less.

    Parameters
    ----------
    region: where the frozen poles of the filtering error must lie.
    fastest_pole: bound on the modulus of the filter's poles (1/s); without region or bound the best filter may not
        exist, and gains grow without end.

    Raises
    ------
    ImpossibleIndexError: for an index that no filter can meet on this plant.
    ArgumentError: for an order outside 1...n, or an error plant that is unstable.
    SolverError: if the solver failed, which includes plants with poles outside the region.
    """
    index.check(plant)
    states = plant.sizes["x"]
    size = states if order is None else order
    if not 1 <= size <= states:
        raise ArgumentError("order", f"between 1 and the plant's order {states}", str(order))
    if fastest_pole is not None:
        finite_number("fastest_pole", fastest_pole, low=0.0, open_low=True)
    check_plant(plant, region)
    regions = []
    if region is not None:
        offset, slope = region.matrices
        regions.append((to_float(offset), to_float(slope)))
    problem = Synthesis(plant.data(), index, size, regions, fastest_pole)
    unknowns = problem.unknowns
    linear = np.zeros(unknowns.size)
    linear[-1] = 1.0
    found = minimise(coefficients(unknowns, problem.constraints), linear=linear, settings=settings)
    values = unknowns.unpack(found.vector)
    try:
        A, B = np.linalg.solve(values["L"], values["A"]), np.linalg.solve(values["L"], values["B"])
    except np.linalg.LinAlgError as error:
        raise SolverError("the design is degenerate: its Lyapunov matrix is singular; bound fastest_pole") from error
    filtering = Filter.of(A, B, values["C"], digits=digits)
    analysis = analyse_filter(plant, filtering, index, region=region, settings=settings) if certify else None
    level = float(values["level"][0, 0])
    return FilterDesign(filtering, index.figure_at(level), analysis, found.status, found.iterations)


def check_plant(plant: FilterPlant, region: Region | None) -> None:
    """Poles that no filter can move: the plant's own are poles of the error too."""
    for vertex, matrix in enumerate(plant.data()["A"]):
        poles = np.linalg.eigvals(matrix)
        if poles.real.max() >= 0.0:
            raise ArgumentError(
                "plant",
                "stable at every vertex",
                f"a pole {poles[poles.real.argmax()]:.4g} at vertex {vertex}",
                "the error contains the plant, which no filter stabilises",
            )
        if region is not None and not region.contains(poles).all():
            outside = poles[~region.contains(poles)][0]
            raise ArgumentError(
                "region",
                "one that holds the plant's own poles",
                f"{outside:.6g} of vertex {vertex} outside {region.name}",
                "the error contains the plant, whose poles no filter moves: widen the region",
            )
