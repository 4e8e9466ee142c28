"""Polytopic models: what is refused, and what a model is."""

import math

import numpy as np
import pytest

from robust_core.checks import finite_array, finite_number, symmetric
from robust_core.errors import ArgumentError, RateError
from robust_core.models import PolytopicSystem, RateBounds, Simplices
from robust_core.plants import chua, example_2_4_1
from robust_core.rational import exact_array, rational
from robust_core.theorems import ParameterDependent, Relaxed, Slack, TensorCorners, TensorProduct

GOOD = [[[-1.0, 0.0], [0.0, -2.0]], [[-3.0, 1.0], [0.0, -1.0]]]


@pytest.mark.parametrize(
    ("A", "expected"),
    [
        ([[-1.0, 0.0], [0.0, -1.0]], r"A must be an array \(\*, \*, \*\)"),
        ([[[-1.0, 0.0]]], "one square matrix per vertex"),
        ([[[math.nan]]], "nan at"),
        ([[[math.inf]]], "inf at"),
        ([], "finite numbers"),
        ([[["x"]]], "finite and rational"),
        ([[[1.0]], [[1.0, 2.0]]], "different lengths"),
        (None, "A|number"),
    ],
)
def test_malformed_vertices_are_refused_by_name(A, expected) -> None:
    with pytest.raises(ArgumentError, match=expected):
        PolytopicSystem.of(A)


@pytest.mark.parametrize(
    ("options", "expected"),
    [
        ({"B": [[1.0]]}, "B must be"),
        ({"B": [[[1.0], [0.0]]]}, "B must be"),
        ({"rates": [1.0]}, "2 bounds, one per weight"),
        ({"rates": [1.0, -1.0]}, "non-negative"),
        ({"rates": [1.0, math.nan]}, "nan"),
        ({"groups": [(0,), (0, 1)]}, "partition"),
        ({"groups": [(0,), ()]}, "partition"),
        ({"groups": [(0,), (1,)], "totals": ["1/2", "1/3"]}, "sum 1"),
        ({"groups": [(0,), (1,)], "totals": [2, -1]}, "sum 1"),
        ({"groups": [(0,), (1,)], "totals": [1]}, "one positive number per group"),
    ],
)
def test_malformed_options_are_refused_by_name(options, expected) -> None:
    with pytest.raises(ArgumentError, match=expected):
        PolytopicSystem.of(GOOD, **options)


def test_reversed_rate_bounds_are_refused() -> None:
    with pytest.raises(ArgumentError, match="at most high"):
        RateBounds(np.array([2.0]), np.array([1.0]), proven=True)


def test_digest_tells_models_apart_and_survives_json() -> None:
    model = PolytopicSystem.of(GOOD, [[1.0], [0.0]], groups=[(0,), (1,)], totals=["1/3", "2/3"], rates=[0.0, 0.0])
    assert PolytopicSystem.from_json(model.to_json()).digest == model.digest
    other = PolytopicSystem.of(GOOD, [[1.0], [0.0]], groups=[(0,), (1,)], totals=["2/3", "1/3"], rates=[0.0, 0.0])
    nudged = np.array(GOOD)
    nudged[0, 0, 0] = np.nextafter(nudged[0, 0, 0], 0.0)
    digests = {model.digest, other.digest, PolytopicSystem.of(GOOD).digest, PolytopicSystem.of(nudged).digest}
    assert len(digests) == 4


def test_attained_vertices_mix_one_member_of_each_group() -> None:
    model = example_2_4_1.system(-14, 100)
    attained = model.attained()
    expected = [(model.A[k] + model.A[j]) / 2 for k in (0, 1) for j in (2, 3)]
    assert np.allclose(attained.A, expected, rtol=1e-15)
    assert attained.rates is None
    assert Simplices.of(3).choices() == ((0,), (1,), (2,))


def test_exact_decimals_are_not_their_floats() -> None:
    exact = example_2_4_1.vertices(0, 1)
    assert exact[1, 1, 0] == rational("1/5")
    assert rational(0.6 - 0.4) != rational("1/5")


def test_closed_loop_is_exact_and_needs_one_b() -> None:
    loop = chua.stabilisation().closed_loop(chua.PRINTED_STABILISATION_GAINS)
    assert loop.exact_state_matrices[0, 0, 0] == rational("-10/7") + rational("1.5095")
    with pytest.raises(ArgumentError, match="without B"):
        loop.closed_loop(chua.PRINTED_STABILISATION_GAINS)
    two = PolytopicSystem.of(GOOD, [[[1.0], [0.0]], [[-1.0], [0.0]]])
    with pytest.raises(ArgumentError, match="pairs"):
        two.closed_loop(np.zeros((2, 1, 2)))
    with pytest.raises(ArgumentError, match="one gain per vertex"):
        chua.stabilisation().closed_loop(np.zeros((2, 1, 3)))


@pytest.mark.parametrize("theorem", [ParameterDependent(), Relaxed(), Slack(), TensorCorners(), TensorProduct()])
def test_theorems_on_rates_say_so_when_there_are_none(theorem) -> None:
    with pytest.raises(RateError, match="whole box"):
        theorem.specialised(PolytopicSystem.of(GOOD))


@pytest.mark.parametrize("bad", ["x", None, math.nan, math.inf, -1.0, 11.0])
def test_numbers_out_of_range_are_refused_by_name(bad) -> None:
    with pytest.raises(ArgumentError, match="gain"):
        finite_number("gain", bad, low=0.0, high=10.0)
    assert finite_number("gain", "2.5", low=0.0, high=10.0) == 2.5


def test_asymmetry_is_refused_not_averaged_away() -> None:
    with pytest.raises(ArgumentError, match=r"symmetric, got 2.0 at \(0, 1\)"):
        symmetric("Q", [[1.0, 2.0], [3.0, 1.0]])
    with pytest.raises(ArgumentError, match="square"):
        symmetric("Q", [[1.0, 2.0]])
    with pytest.raises(ArgumentError, match="list that is not one"):
        finite_array("Q", [["a"]], (1, 1))
    assert symmetric("Q", [[1.0, 2.0], [2.0 + 1e-15, 1.0]])[1, 0] == pytest.approx(2.0)


def test_bounds_at_both_ends_reach_the_formulas() -> None:
    model = PolytopicSystem.of(GOOD, rates=RateBounds(np.array([0.1, 0.2]), np.array([0.3, 0.4]), proven=True))
    assert model.data(bound="low")["phi"].tolist() == [0.1, 0.2]
    assert (model.data(exact=True)["phi"] == exact_array([0.3, 0.4])).all()
