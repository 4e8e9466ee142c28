"""Filters under the extended dissipative index, against the figures of the errata and against frequency responses."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from robust_core.analysis import decide
from robust_core.certificates import load_certificate, save_certificate
from robust_core.errors import ArgumentError, SolverError
from robust_core.filtering import (
    DissipativeFilter,
    DissipativeIndex,
    Filter,
    ImpossibleIndexError,
    analyse_filter,
    band_gain,
    design_filter,
    dissipative,
    energy_to_peak,
    error_gain,
    error_poles_model,
    h_infinity,
    passive,
    very_strictly_passive,
)
from robust_core.models import FilterPlant
from robust_core.plants.tunnel_diode import PRINTED_FILTER, tunnel_diode
from robust_core.theorems import DStability
from robust_core.theorems.regions import disc
from robust_core.verdict import Verdict

DISC = disc(-20.0, 19.9)
PRINTED = tunnel_diode()
TRUE = PRINTED.attained()
THESIS_FILTER = Filter.of(PRINTED_FILTER["A"], PRINTED_FILTER["B"], PRINTED_FILTER["C"])


@pytest.mark.parametrize(
    ("index", "printed", "true"),
    [
        (h_infinity(), 0.123136, 0.038312),
        (energy_to_peak(), 0.236451, 0.085946),
        (passive(), 0.009982, 0.005116),
        (dissipative(-1, 1, 0), -0.010007, -0.005122),
        (dissipative("-1/4", 1, 0), -0.009988, -0.005117),
        (dissipative("-1/2", "1/2", 0), -0.005003, -0.002561),
    ],
    ids=["h_infinity", "energy_to_peak", "passive", "Q=-1", "Q=-1/4", "Q=-1/2"],
)
def test_optima_of_the_errata_are_reached_and_proven(index: Any, printed: Any, true: Any) -> None:
    for plant, figure in ((PRINTED, printed), (TRUE, true)):
        design = design_filter(plant, index, region=DISC)
        assert design.optimum == pytest.approx(figure, rel=2e-4)
        assert design.analysis is not None
        assert design.analysis.result.verdict is Verdict.PROVEN
        assert design.analysis.figure == pytest.approx(figure, rel=2e-4)


def test_printed_filter_is_certified_at_what_the_errata_say() -> None:
    assert analyse_filter(PRINTED, THESIS_FILTER, h_infinity(), region=DISC).figure == pytest.approx(0.1647, abs=1e-4)
    assert analyse_filter(TRUE, THESIS_FILTER, h_infinity(), region=DISC).figure == pytest.approx(0.0436, abs=1e-4)


def test_a_level_below_the_optimum_is_never_proven() -> None:
    claim = DissipativeFilter(THESIS_FILTER, h_infinity(), str(0.16**2), DISC)
    assert decide(claim, PRINTED).verdict in (Verdict.INFEASIBLE, Verdict.UNDECIDED)


@pytest.mark.parametrize("plant", [PRINTED, TRUE], ids=["printed", "true"])
def test_certified_gain_is_above_every_frequency_response(plant: Any) -> None:
    design = design_filter(plant, h_infinity(), region=DISC)
    assert design.analysis is not None
    gains = error_gain(plant, design.filtering, np.logspace(-2, 4, 400))
    assert gains.max() <= design.analysis.figure


def test_frozen_poles_of_a_certified_filter_are_in_the_region() -> None:
    design = design_filter(TRUE, h_infinity(), region=DISC)
    model = error_poles_model(TRUE, design.filtering)
    assert all(DISC.contains(np.linalg.eigvals(matrix)).all() for matrix in model.A)
    assert decide(DStability.within(DISC), model).verdict is Verdict.PROVEN


def test_reduced_order_costs_performance_and_is_proven() -> None:
    full, reduced = (design_filter(TRUE, h_infinity(), region=DISC, order=order) for order in (2, 1))
    assert reduced.filtering.order == 1
    assert reduced.analysis is not None
    assert full.analysis is not None
    assert reduced.analysis.result.verdict is Verdict.PROVEN
    assert reduced.analysis.figure > full.analysis.figure


def test_without_a_region_gains_are_bounded_on_request() -> None:
    design = design_filter(PRINTED, h_infinity(), fastest_pole=60.0)
    assert np.abs(np.linalg.eigvals(design.filtering.matrices()[0])).max() <= 60.0
    assert design.analysis is not None
    assert design.analysis.result.verdict is Verdict.PROVEN
    assert design.optimum > 0.0775


def test_an_unattained_optimum_is_never_called_proven() -> None:
    try:
        design = design_filter(PRINTED, h_infinity())
    except SolverError:
        return
    assert design.analysis is not None
    if design.analysis.result.verdict is Verdict.PROVEN:
        gains = error_gain(PRINTED, design.filtering, np.logspace(-2, 4, 400))
        assert gains.max() <= design.analysis.figure


def test_very_strict_passivity_without_feedthrough_is_refused() -> None:
    with pytest.raises(ImpossibleIndexError, match=r"Assumption 1\.5"):
        design_filter(PRINTED, very_strictly_passive("0.01"), region=DISC)
    with pytest.raises(ImpossibleIndexError, match=r"Assumption 1\.5"):
        decide(DissipativeFilter(THESIS_FILTER, very_strictly_passive("0.01"), "-0.001"), PRINTED)


def test_very_strict_passivity_with_feedthrough_is_designed() -> None:
    plant = FilterPlant.of(A=[[[-1.0]], [[-2.0]]], B=[[1.0]], C=[[1.0]], D=[[1.0]], E=[[1.0]], F=[[0.1]])
    design = design_filter(plant, very_strictly_passive("0.1"), region=disc(-10.0, 9.5))
    assert design.optimum > 0.0
    assert design.analysis is not None
    assert design.analysis.result.verdict is Verdict.PROVEN


@pytest.mark.parametrize(
    "index",
    [
        energy_to_peak(),
        DissipativeIndex("x", *(((("-1",),),) + ((("0",),),) * 2), (("0",),)),
        h_infinity(2, 1),
        passive(2),
    ],
    ids=["feedthrough", "negative Phi", "wrong z", "wrong sizes"],
)
def test_indices_that_break_the_assumption_are_refused(index: Any) -> None:
    plant = FilterPlant.of(A=[[[-1.0]]], B=[[1.0]], C=[[1.0]], D=[[1.0]], E=[[1.0]])
    with pytest.raises(ImpossibleIndexError):
        design_filter(plant, index)


def test_plants_that_no_filter_can_serve_are_refused_with_the_reason() -> None:
    unstable = FilterPlant.of(A=[[[0.1]]], B=[[1.0]], C=[[1.0]], E=[[1.0]])
    with pytest.raises(ArgumentError, match="stabilises"):
        design_filter(unstable, h_infinity())
    with pytest.raises(ArgumentError, match="widen"):
        design_filter(PRINTED, h_infinity(), region=disc(-20.0, 19.19))
    with pytest.raises(ArgumentError, match="order"):
        design_filter(PRINTED, h_infinity(), order=3)
    with pytest.raises(ArgumentError, match="fastest_pole"):
        design_filter(PRINTED, h_infinity(), fastest_pole=0.0)


def test_several_signals_are_filtered_and_certified() -> None:
    rng = np.random.default_rng(3)
    n, w, z, y, m = 4, 2, 2, 3, 2
    A = -3.0 * np.eye(n) + 0.5 * rng.normal(size=(m, n, n))
    plant = FilterPlant.of(
        A=A, B=rng.normal(size=(m, n, w)), C=rng.normal(size=(m, z, n)), D=0.1 * rng.normal(size=(m, z, w)),
        E=rng.normal(size=(m, y, n)), F=0.5 * rng.normal(size=(m, y, w)),
    )  # fmt: skip
    for order in (n, 2):
        design = design_filter(plant, h_infinity(z, w), region=disc(-20.0, 19.9), order=order)
        assert design.analysis is not None
        assert design.analysis.result.verdict is Verdict.PROVEN
        assert error_gain(plant, design.filtering, np.logspace(-2, 3, 100)).max() <= design.analysis.figure


def test_certificate_of_a_filter_survives_a_file(tmp_path: Path) -> None:
    design = design_filter(TRUE, passive(), region=DISC)
    assert design.analysis is not None
    path = save_certificate(design.analysis.result.require(), tmp_path / "filter.json")
    again = load_certificate(path, model=TRUE)
    assert isinstance(again.theorem, DissipativeFilter)
    assert again.theorem.figure == pytest.approx(design.analysis.figure)


def test_design_without_proof_claims_nothing() -> None:
    assert design_filter(TRUE, h_infinity(), region=DISC, certify=False).analysis is None


@pytest.mark.parametrize(
    "change",
    [
        {"A": [[[-1.0, 2.0]]]},
        {"A": [[[np.nan]]]},
        {"B": [[1.0], [2.0]]},
        {"C": [[1.0, 2.0]]},
        {"D": [[1.0, 1.0]]},
        {"E": [[np.inf]]},
        {"groups": [[0, 1]]},
    ],
)
def test_malformed_plants_are_refused(change: Any) -> None:
    with pytest.raises(ArgumentError):
        FilterPlant.of(**{"A": [[[-1.0]]], "B": [[1.0]], "C": [[1.0]], "E": [[1.0]], **change})


def test_filters_that_do_not_fit_are_refused() -> None:
    with pytest.raises(ArgumentError, match="B must"):
        analyse_filter(PRINTED, Filter.of([[-1.0]], [[1.0, 1.0]], [[1.0]]), h_infinity())
    with pytest.raises(ArgumentError, match="C must"):
        analyse_filter(PRINTED, Filter.of([[-1.0]], [[1.0]], [[1.0], [1.0]]), h_infinity())
    with pytest.raises(ArgumentError):
        Filter.of([[-1.0, 0.0]], [[1.0]], [[1.0]])


def test_attained_vertices_are_the_true_ones() -> None:
    assert sorted(TRUE.floats["A"][:, 0, 0].tolist()) == pytest.approx([-4.6, -4.6, -0.1, -0.1])
    assert sorted(TRUE.floats["A"][:, 1, 1].tolist()) == pytest.approx([-13.0, -13.0, -7.0, -7.0])
    assert FilterPlant.from_json(TRUE.to_json()).digest == TRUE.digest


def test_band_gain_is_that_of_the_worst_vertex() -> None:
    gains = error_gain(TRUE, THESIS_FILTER, np.array([5.0, 6.0, 7.0]))
    assert gains.shape == (4, 3)
    assert band_gain(TRUE, THESIS_FILTER, (5.0, 7.0), points=3) == pytest.approx(gains.max())
