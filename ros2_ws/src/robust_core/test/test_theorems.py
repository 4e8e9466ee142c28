"""The stability theorems of chapter 2: what contains what, the errata, and the figures of example 2.4.1."""

import itertools
import math

import numpy as np
import pytest

from robust_core.analysis import decide, decide_many, largest_decay, sweep
from robust_core.errors import ArgumentError, NotProvenError
from robust_core.lmi.margin import MarginSolver
from robust_core.models import PolytopicSystem, RateBounds
from robust_core.plants import chua, example_2_4_1
from robust_core.samples import random_systems
from robust_core.theorems import (
    CommonLyapunov,
    DStability,
    ParameterDependent,
    Relaxed,
    Slack,
    TensorCorners,
    TensorProduct,
)
from robust_core.theorems.regions import disc, half_plane, intersection, sector
from robust_core.verdict import Verdict

ALL = (CommonLyapunov(), ParameterDependent(), Relaxed(), Slack(), TensorCorners(), TensorProduct())
COUNTEREXAMPLE = [[[1.0, -7.0], [6.0, -3.0]], [[-6.0, -6.0], [7.0, 3.0]]]


def test_theorem_2_2_can_hold_where_2_3_does_not() -> None:
    """Erratum 2.2.11: 2.3 is not always less conservative than 2.2; the slack form contains both."""
    model = PolytopicSystem.of(COUNTEREXAMPLE, rates=[0.01, 0.01])
    assert decide(ParameterDependent(), model).verdict is Verdict.PROVEN
    for z in (0, 1):
        assert decide(Relaxed(z=z), model).verdict is Verdict.INFEASIBLE
    for theorem in (Slack(), TensorCorners(), TensorProduct()):
        assert decide(theorem, model).verdict is Verdict.PROVEN


@pytest.mark.parametrize("half_width", [math.pi / 40, math.pi / 2])
def test_figures_of_example_2_4_1_on_the_11_x_11_grid(half_width) -> None:
    found = sweep(ALL, example_2_4_1.Family(half_width), example_2_4_1.grid(11), workers=1)
    counts = [found.count(row, Verdict.PROVEN) for row in range(len(ALL))]
    expected = {math.pi / 40: [5, 81, 89, 94, 100, 121], math.pi / 2: [5, 0, 51, 51, 65, 98]}
    assert counts == expected[half_width]
    assert all(found.count(row, Verdict.UNDECIDED) == 0 for row in range(len(ALL)))
    proven = {
        theorem.NAME: set(np.flatnonzero(row == Verdict.PROVEN))
        for theorem, row in zip(ALL, found.verdicts, strict=True)
    }
    for small, large in itertools.pairwise(("2.3", "slack", "T1", "T2")):
        assert proven[small] <= proven[large]
    assert proven["2.1"] | proven["2.2"] <= proven["slack"]


def test_true_vertices_make_theorem_2_1_hold_far_more_often() -> None:
    points = example_2_4_1.grid(11)
    results = decide_many(CommonLyapunov(), [example_2_4_1.system(a, b).attained() for a, b in points.tolist()])
    assert sum(result.verdict is Verdict.PROVEN for result in results) > 10 * 5 - 10


def test_theorem_2_3_without_its_ordering_would_be_false() -> None:
    """Erratum 2.2.7: dropping P_r >= P_z makes infeasible points feasible."""
    from robust_core.lmi.coefficients import coefficients

    model = example_2_4_1.Family(math.pi / 2)(np.array([[0.0, 200.0]]))[0]
    theorem = Relaxed().specialised(model)
    families = coefficients(theorem.unknowns(model), lambda probes: theorem.constraints(theorem.data(model), probes))
    assert MarginSolver().solve(families).margin < 0.0
    assert MarginSolver().solve([one for one in families if ">= 0" not in one.name]).margin > 0.0


def test_verdicts_do_not_depend_on_how_they_were_solved() -> None:
    models = example_2_4_1.Family(math.pi / 2)(example_2_4_1.grid(4))
    for theorem in ALL:
        shared = MarginSolver()
        for model, batched in zip(models, decide_many(theorem, models), strict=True):
            kept = [decide(theorem, model, solver=shared).verdict for _ in range(3)]
            assert {batched.verdict, decide(theorem, model).verdict, *kept} == {batched.verdict}


def test_sampled_rates_never_prove() -> None:
    phi = np.array([1.126, 1.126, 0.1461, 0.1476])
    model = example_2_4_1.system(-14, 100, RateBounds(phi, phi, proven=False))
    result = decide(Relaxed(), model)
    assert result.verdict is Verdict.SUPPORTED
    assert result.certificate is not None
    with pytest.raises(NotProvenError, match="sampled"):
        result.require()
    huge = example_2_4_1.system(0, 200, RateBounds(100 * phi, 100 * phi, proven=False))
    assert decide(ParameterDependent(), huge).verdict is Verdict.UNDECIDED


def test_without_exact_arithmetic_nothing_is_proven() -> None:
    assert decide(CommonLyapunov(), PolytopicSystem.of([-np.eye(2)]), exact=False).verdict is Verdict.SUPPORTED
    unstable = decide(CommonLyapunov(), PolytopicSystem.of([np.eye(2)]), exact=False)
    assert unstable.verdict is Verdict.UNDECIDED
    assert "exact" in unstable.reason


@pytest.mark.parametrize(
    "A",
    [
        [[[0.0, 1.0], [-1.0, 0.0]]],  # Centre: P exists, strictness does not.
        [[[-1.0, 0.0], [0.0, 0.0]]],  # Common null vector.
        [[[0.0, 1.0], [0.0, 0.0]]],  # Jordan block at the origin.
        [[[0.0]]],
        [[[0.0, 0.0], [0.0, 0.0]]],
        [[[-1.0, 0.0], [0.0, -1.0]], [[-1.0, 0.0], [0.0, 0.0]]],
    ],
)
def test_degenerate_systems_are_never_proven(A) -> None:
    for factor in (1e-9, 1.0, 1e9):
        result = decide(CommonLyapunov(), PolytopicSystem.of(factor * np.array(A)))
        assert result.verdict in (Verdict.UNDECIDED, Verdict.INFEASIBLE)


@pytest.mark.parametrize("rates", [False, True])
def test_no_verdict_contradicts_how_a_random_system_was_made(rates) -> None:
    theorems = (Relaxed(), Slack(), TensorCorners(), ParameterDependent()) if rates else (CommonLyapunov(),)
    sizes = {"states": (2, 3), "vertices": (2, 3)} if rates else {}
    decided = 0
    for number, sample in enumerate(random_systems(7, 60, rates=rates, **sizes)):
        theorem = theorems[number % len(theorems)]
        verdict = decide(theorem, sample.model).verdict
        if sample.feasible is False:
            assert verdict is not Verdict.PROVEN, sample.made
        if sample.feasible is True and not isinstance(theorem, ParameterDependent):
            assert verdict is Verdict.PROVEN, sample.made
        decided += verdict is not Verdict.UNDECIDED
    assert decided >= 54


def test_printed_chua_gains_are_certified_with_their_decay() -> None:
    for model, gains, expected in (
        (chua.stabilisation(), chua.PRINTED_STABILISATION_GAINS, 0.376),
        (chua.synchronisation(), chua.PRINTED_SYNCHRONISATION_GAINS, 0.154),
    ):
        decay, result = largest_decay(CommonLyapunov(), model.closed_loop(gains))
        assert result.verdict is Verdict.PROVEN
        assert decay == pytest.approx(expected, abs=5e-4)
        assert decide(CommonLyapunov(decay=1.01 * decay), model.closed_loop(gains)).verdict is Verdict.INFEASIBLE


def test_decay_of_a_diagonal_system_is_its_slowest_mode() -> None:
    decay, result = largest_decay(CommonLyapunov(), PolytopicSystem.of([np.diag([-2.0, -0.5])]))
    assert decay == pytest.approx(0.5, rel=1e-3)
    assert result.verdict is Verdict.PROVEN
    assert largest_decay(CommonLyapunov(), PolytopicSystem.of([np.eye(2)]))[1].verdict is Verdict.INFEASIBLE


@pytest.mark.parametrize("bad", [-1.0, math.nan, "x", None])
def test_decays_that_are_no_rate_are_refused(bad) -> None:
    with pytest.raises(ArgumentError, match="decay"):
        CommonLyapunov(decay=bad)


def test_eliminated_weights_outside_the_model_are_refused() -> None:
    with pytest.raises(ArgumentError, match="z must be"):
        decide(Relaxed(z=4), example_2_4_1.system(-14, 100, [1.0] * 4))


@pytest.mark.parametrize(
    ("region", "inside", "outside"),
    [
        (disc(-20.0, 19.9), [-1.0, -20.0 + 19.8j], [0.0, -40.0]),
        (half_plane(-2.0), [-3.0, -2.1 + 50.0j], [-1.9, 1.0]),
        (sector(math.pi / 4), [-1.0 + 0.9j, -5.0], [-1.0 + 1.1j, 1.0]),
        (disc(-20.0, 19.9) & half_plane(-2.0), [-3.0], [-1.0, -41.0]),
        (intersection([sector(0.5), half_plane(-1.0)]), [-2.0], [-2.0 + 2.0j, -0.5]),
    ],
    ids=["disc", "half plane", "sector", "and", "intersection"],
)
def test_regions_hold_the_poles_that_they_should(region, inside, outside) -> None:
    assert region.contains(inside).all()
    assert not region.contains(outside).any()
    for pole in inside:
        real = np.array([[np.real(pole), np.imag(pole)], [-np.imag(pole), np.real(pole)]])
        assert decide(DStability.within(region), PolytopicSystem.of([real])).verdict is Verdict.PROVEN
    for pole in outside:
        real = np.array([[np.real(pole), np.imag(pole)], [-np.imag(pole), np.real(pole)]])
        assert decide(DStability.within(region), PolytopicSystem.of([real])).verdict is not Verdict.PROVEN


def test_malformed_regions_are_refused() -> None:
    with pytest.raises(ArgumentError, match="radius"):
        disc(0.0, 0.0)
    with pytest.raises(ArgumentError, match="half_plane"):
        sector(math.pi / 2)
    with pytest.raises(ArgumentError, match="within"):
        DStability()
    with pytest.raises(ArgumentError, match="at least one"):
        intersection([])
