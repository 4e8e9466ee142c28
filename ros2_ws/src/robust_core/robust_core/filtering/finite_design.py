"""Design of filters for disturbances in a band of frequencies.

In the lemma of :mod:`~robust_core.filtering.finite_frequency` the slack's columns that meet the filter are tied to one
matrix L, times 1 in the rows of x' and times a scalar in those of x, which is searched; the plant's columns are free.
With L A_f, L B_f, C_f as unknowns all is affine, and stability and region take V = [R, L; L, L] as in Theorem 3.2. The
filter is rounded and proven on its own with a slack that is free.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from robust_core.analysis import Result, decide
from robust_core.checks import finite_number
from robust_core.errors import ArgumentError, SolverError
from robust_core.filtering.band import band_gain
from robust_core.filtering.complex_form import ComplexForm, complex_blocks, hermitian, real_form
from robust_core.filtering.design import check_plant
from robust_core.filtering.filter import Filter
from robust_core.filtering.finite_frequency import FiniteFrequencyFilter, frequency_form
from robust_core.lmi import Constraint, Unknown, Unknowns, he
from robust_core.lmi.coefficients import coefficients
from robust_core.lmi.constraint import blocks, transpose
from robust_core.lmi.objective import minimise
from robust_core.lmi.settings import SolverSettings
from robust_core.lmi.unknowns import Values
from robust_core.models import FilterPlant
from robust_core.rational import Floats, to_float
from robust_core.theorems.d_stability import kronecker
from robust_core.theorems.regions import Region
from robust_core.verdict import Verdict

RATIOS = (0.05, 0.2, 1.0, 3.0)
"""Where the scalar of the slack is searched, in units of the middle of the band."""

RESERVES = (1e-4, 1e-3, 5e-3, 2e-2, 1e-1)
"""Relative distances above the gain on a grid at which a proof is tried."""


@dataclass(frozen=True, slots=True)
class FiniteFrequencyDesign:
    """The filter, its proven gain in the band ``gamma`` (NaN without a proof), its gain on a grid, and the result."""

    filtering: Filter
    gamma: float
    grid_gamma: float
    result: Result


@dataclass(frozen=True, slots=True)
class BandSynthesis:
    """The inequalities in floats: time in units of 1 / w_c, the estimated signal in units of ``unit``."""

    data: Any
    product: float
    center: float
    ratio: float
    unit: float
    region: tuple[Floats, Floats] | None

    @property
    def unknowns(self) -> Unknowns:
        """P, Q per vertex, the free columns of the slack, V's parts, the filter's parts and the squared gain."""
        n, z, y = self.data["A"].shape[-1], self.data["C"].shape[-2], self.data["E"].shape[-2]
        m, w = len(self.data["A"]), self.data["B"].shape[-1]
        return Unknowns(
            (
                Unknown("P", 2 * n, count=m),
                Unknown("Q", 2 * n, count=m),
                Unknown("G", 4 * n + w, n, count=2),
                Unknown("R", n, symmetric=True),
                Unknown("L", n, symmetric=True),
                Unknown("A", n),
                Unknown("B", n, y),
                Unknown("C", z, n),
                Unknown("level", 1),
            )
        )

    def constraints(self, values: Values) -> list[Constraint]:
        """The lemma, Q > 0, stability and the region."""
        d = self.data
        R, L, A, B, C, level = (values[name][..., None, :, :] for name in ("R", "L", "A", "B", "C", "level"))
        n, w, z = d["A"].shape[-1], d["B"].shape[-1], C.shape[-2]
        slow, zero = 1.0 / self.center, np.zeros((n, n))
        plant = blocks([[-np.eye(n), zero, slow * d["A"], zero, slow * d["B"]]])
        tied = blocks([[zero, -L, slow * (B @ d["E"]), slow * A, slow * (B @ d["F"])]])
        rows = blocks([[tied], [tied], [self.ratio * tied], [self.ratio * tied], [np.zeros((w, tied.shape[-1]))]])
        free = ComplexForm(values["G"][..., 0, None, :, :], values["G"][..., 1, None, :, :])
        pushed = ComplexForm(free.real @ plant + rows, free.imaginary @ plant)
        nothing = np.zeros((2 * n, 2 * n))
        P, Q = hermitian(values["P"]), hermitian(values["Q"])
        lemma = frequency_form(P, Q, self.product, nothing, np.zeros((2 * n, w)), -level * np.eye(w))
        whole = lemma + pushed + pushed.adjoint
        output = real_form(blocks([[np.zeros((z, 2 * n)), d["C"] / self.unit, -C, d["D"] / self.unit]]))
        bordered = complex_blocks([[whole, output.adjoint], [output, real_form(-np.eye(z))]])
        V = blocks([[R, L], [L, L]])
        flow = blocks([[R @ d["A"] + B @ d["E"], A], [L @ d["A"] + B @ d["E"], A]])
        found = [
            Constraint("Q > 0", Q.embedded()),
            Constraint("gain in the band", -bordered.embedded()),
            Constraint("V > 0", V),
        ]
        if self.region is None:
            found.append(Constraint("stability", -he(flow)))
        else:
            offset, slope = self.region
            inside = kronecker(offset, V) + kronecker(slope, flow) + kronecker(slope.T, transpose(flow))
            found.append(Constraint("poles", -inside))
        return found


def design_finite_frequency(
    plant: FilterPlant,
    band: tuple[float, float],
    *,
    region: Region | None = None,
    ratios: Sequence[float] = RATIOS,
    digits: int = 7,
    settings: SolverSettings | None = None,
) -> FiniteFrequencyDesign:
    """The full-order filter with the smallest gain over ``band`` (rad/s) for every frozen weight.

    Parameters
    ----------
    region: where the frozen poles of the filtering error must lie; without one they are only stable, and gains may
    grow. ratios: values of the slack's scalar that are tried, in units of the band's middle.

    Raises
    ------
    ArgumentError: for an empty or reversed band, or a plant whose own poles forbid the region.
    SolverError: if the solver failed for every ratio.
    """
    low = finite_number("band[0]", band[0], low=0.0)
    high = finite_number("band[1]", band[1], low=low, open_low=True)
    check_plant(plant, region)
    data, center = plant.data(), 0.5 * (low + high)
    pair = None if region is None else region.matrices
    matrices = None if pair is None else (to_float(pair[0]), to_float(pair[1]))
    nothing = Filter.of(-np.eye(1), np.zeros((1, plant.sizes["y"])), np.zeros((plant.sizes["z"], 1)))
    unit = band_gain(plant, nothing, (low, high))
    if unit <= 0.0:
        raise ArgumentError("plant", "one whose signal the disturbance moves", "no gain in the band")
    best: tuple[float, Filter] | None = None
    failures = []
    for ratio in ratios:
        problem = BandSynthesis(data, low * high / center**2, center, float(ratio), unit, matrices)
        try:
            filtering = _solve(problem, unit, digits, settings)
        except (SolverError, ArgumentError, np.linalg.LinAlgError) as error:
            failures.append(f"ratio {ratio:g}: {error}")
            continue
        reached = band_gain(plant, filtering, (low, high))
        if best is None or reached < best[0]:
            best = (reached, filtering)
    if best is None:
        raise SolverError(f"no filter was found for the band ({'; '.join(failures)})")
    return certify_band(plant, best[1], (low, high), region=region)


def certify_band(
    plant: FilterPlant, filtering: Filter, band: tuple[float, float], *, region: Region | None = None
) -> FiniteFrequencyDesign:
    """Prove the gain of a given filter over a band, a little above its gain on a grid of the vertices."""
    reached = band_gain(plant, filtering, band)
    result = Result(Verdict.UNDECIDED, "no proof was tried", 0.0)
    for reserve in RESERVES:
        gamma = float(f"{reached * (1.0 + reserve):.9e}")
        claim = FiniteFrequencyFilter(filtering, repr(float(band[0])), repr(float(band[1])), repr(gamma), region)
        try:
            result = decide(claim, plant)
        except SolverError as error:
            result = Result(Verdict.UNDECIDED, str(error), 0.0)
            continue
        if result.verdict is Verdict.PROVEN:
            return FiniteFrequencyDesign(filtering, gamma, reached, result)
    return FiniteFrequencyDesign(filtering, float("nan"), reached, result)


def _solve(problem: BandSynthesis, unit: float, digits: int, settings: SolverSettings | None) -> Filter:
    unknowns = problem.unknowns
    linear = np.zeros(unknowns.size)
    linear[-1] = 1.0
    found = minimise(coefficients(unknowns, problem.constraints), linear=linear, settings=settings)
    values = unknowns.unpack(found.vector)
    A, B = np.linalg.solve(values["L"], values["A"]), np.linalg.solve(values["L"], values["B"])
    return Filter.of(A, B, values["C"] * unit, digits=digits)
