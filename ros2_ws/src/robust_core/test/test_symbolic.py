"""Models from formulas: agreement with the original, and bounds on rates that hold over the whole box."""

import math
import sys

import casadi
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from robust_core.errors import ArgumentError, EnclosureError, MissingDependencyError, ModelMismatchError, RateError
from robust_core.plants import chua, chua_formulas, example_2_4_1
from robust_core.symbolic import StateDependentModel, Term, check_agreement, derive
from robust_core.symbolic.interval import BallFunction, box_balls, middles_and_radii
from robust_core.symbolic.packages import casadi_module, flint_module
from robust_core.symbolic.supremum import Supremum

PI2 = math.pi / 2


def test_phi_of_example_2_4_1_is_enclosed() -> None:
    for half_width, expected in (
        (math.pi / 40, [1.1255, 1.1255, 0.1460, 0.1476]),
        (PI2, [15.3671, 25.7386, 1.7374, 1.8054]),
    ):
        rates = example_2_4_1.symbolic(half_width).rates((-14, 100))
        assert np.allclose(rates.high, expected, atol=6e-5)
        assert (rates.high - rates.low <= 2e-6 * rates.high).all()
        assert rates.proven


def test_corners_of_the_box_would_give_zero() -> None:
    """Erratum 2.4.1: at +-pi/2 every corner has cos = 0; the whole box counts."""
    model = example_2_4_1.symbolic(PI2)
    function = casadi.Function("r", [model.variables, model.parameters], [model.weight_rates])
    corners = [function([i * PI2, j * PI2], [-14, 100]) for i in (-1, 1) for j in (-1, 1)]
    assert np.abs(np.array(corners)).max() < 1e-12
    assert (model.rates((-14, 100), method="sampled").high > 1.7).all()
    with pytest.raises(RateError, match="false map"):
        model.rates((-14, 100), method="corners")
    with pytest.raises(ArgumentError, match="method"):
        model.rates((-14, 100), method="guess")


def test_sampled_bounds_stay_below_the_enclosure_and_prove_nothing() -> None:
    model = example_2_4_1.symbolic(PI2)
    sampled, enclosed = model.rates((-20, 200), method="sampled"), model.rates((-20, 200))
    assert (sampled.high <= enclosed.high).all()
    assert not sampled.proven


def test_bounds_for_many_parameters_are_those_for_each() -> None:
    model, points = example_2_4_1.symbolic(PI2), np.array([[-20.0, 200.0], [0.0, 100.0], [-7.0, 130.0]])
    for bounds, point in zip(model.rate_map().bounds(points), points, strict=True):
        single = model.rates(point)
        assert (bounds.low <= single.high).all()
        assert (single.low <= bounds.high).all()


@settings(max_examples=25)
@given(st.floats(-1.0, 1.0), st.floats(-1.0, 1.0), st.floats(-20.0, 0.0), st.floats(100.0, 200.0))
def test_no_point_of_the_box_exceeds_the_upper_bound(u, v, alpha, beta) -> None:
    bounds = MODEL_MAP.bounds(np.array([[alpha, beta]]), relative=1e-3)[0]
    rate = np.array(MODEL_RATES([u * PI2, v * PI2], [alpha, beta])).ravel()
    assert (rate <= bounds.high + 1e-9).all()


MODEL = example_2_4_1.symbolic(PI2)
MODEL_MAP = MODEL.rate_map()
MODEL_RATES = casadi.Function("r", [MODEL.variables, MODEL.parameters], [MODEL.weight_rates])


def test_phi4_of_chua_is_not_the_printed_one() -> None:
    rates = chua_formulas.stabilisation().rates()
    assert rates.low[3] == pytest.approx(3.2227, abs=5e-5)
    assert rates.high[3] == pytest.approx(3.2227, abs=5e-5)
    assert rates.low[3] > chua.PRINTED_PHI4
    assert np.allclose(rates.high[:3], [30.15, 29.85, 120.6], atol=1e-3)


@pytest.mark.parametrize("name", ["stabilisation", "synchronisation"])
def test_derived_vertices_of_chua_are_the_printed_ones(name) -> None:
    derived, printed = getattr(chua_formulas, name)(), getattr(chua, name)()
    assert np.allclose(derived.system().A, printed.A, atol=1e-11)
    assert np.allclose(derived.system().B, printed.B)
    assert derived.simplices == printed.simplices
    check_agreement(derived)


def test_weights_of_chua_are_the_circuits() -> None:
    model = chua_formulas.stabilisation()
    function = casadi.Function("f", [model.variables], [model.matrix @ model.variables, model.weights])
    for state in np.random.default_rng(3).uniform(-6.0, 6.0, (20, 3)):
        flow, weights = function(state)
        assert np.allclose(np.array(flow).ravel(), chua.derivative(state))
        assert np.allclose(np.array(weights).ravel(), chua.stabilisation_weights(state[1]))


def test_printed_entry_of_2_4_1_is_refused_by_name() -> None:
    """Erratum 2.4.1: entry (1, 2) is -4."""
    with pytest.raises(ModelMismatchError, match=r"A\[0, 1\] is off by -3 "):
        check_agreement(example_2_4_1.symbolic(PI2, upper_right=-1.0), (-14, 100))
    assert check_agreement(example_2_4_1.symbolic(PI2), (-14, 100)).matrices < 1e-12


def model_with(**changes) -> StateDependentModel:
    """x' = -x - x^3 as two vertices, with something changed."""
    x = casadi.SX.sym("x")
    options = {
        "states": x,
        "low": [-1.0],
        "high": [1.0],
        "matrix": -1 - x * x,
        "weights": casadi.vertcat(1 - x * x, x * x),
        "vertices": [casadi.SX(-1), casadi.SX(-2)],
    }
    for name, change in changes.items():
        options[name] = change(x) if callable(change) else change
    return StateDependentModel.of(**options)


def test_negative_weights_and_wrong_sums_are_refused() -> None:
    with pytest.raises(ModelMismatchError, match="below 0"):
        check_agreement(model_with(high=[2.0]))
    lost = model_with(
        weights=lambda x: casadi.vertcat(1 - x * x, x * x, 0.1), vertices=[casadi.SX(v) for v in (-1, -2, 0)]
    )
    with pytest.raises(ModelMismatchError, match="sum to"):
        check_agreement(lost)


@pytest.mark.parametrize(
    ("changes", "expected"),
    [
        ({"low": [1.0], "high": [-1.0]}, "above low"),
        ({"low": [0.0], "high": [0.0]}, "above low"),
        ({"low": [0.5]}, "contains the origin"),
        ({"low": [-1.0, -1.0]}, "low must be"),
        ({"low": [math.nan]}, "nan"),
        ({"matrix": casadi.SX.zeros(2, 2)}, "matrix must be"),
        ({"vertices": [casadi.SX(-1)]}, "vertices must be 2"),
        ({"vertices": [casadi.SX(-1), casadi.SX.zeros(2, 2)]}, "vertices must be of shape"),
        ({"motion": casadi.SX.zeros(2)}, "motion must be"),
        ({"input_matrix": casadi.SX(1)}, "inputs must be"),
    ],
)
def test_malformed_models_are_refused_by_name(changes, expected) -> None:
    with pytest.raises(ArgumentError, match=expected):
        model_with(**changes)


def test_rates_that_depend_on_the_input_are_refused_as_circular() -> None:
    with pytest.raises(RateError, match="depend on the input"):
        model_with(input_matrix=casadi.SX(1), inputs=[casadi.SX(1), casadi.SX(1)])


def test_parameters_must_be_numbers_of_the_right_count() -> None:
    with pytest.raises(ArgumentError, match="2 numbers"):
        example_2_4_1.symbolic(1.0).system((1.0,))


def test_rates_that_are_not_affine_in_parameters_are_refused() -> None:
    x, p = casadi.SX.sym("x"), casadi.SX.sym("p")
    model = model_with(parameters=p, motion=-(p**2) * x)
    with pytest.raises(RateError, match="affine"):
        model.rate_map()


def test_terms_get_their_bounds_enclosed_and_products_are_refused() -> None:
    x = casadi.SX.sym("x", 2)
    model = derive(
        states=x,
        low=[-1, -1],
        high=[1, 2],
        terms=[Term(x[1] ** 2)],
        matrix=lambda t: casadi.blockcat([[-1, t], [0, -1]]),
    )
    assert model.system().A[1, 0, 1] == pytest.approx(4.0, rel=1e-5)
    check_agreement(model)
    with pytest.raises(ArgumentError, match="affine in the terms"):
        derive(
            states=x, low=[-1, -1], high=[1, 1], terms=[Term(x[0], -1, 1)], matrix=lambda t: -t * t * casadi.SX.eye(2)
        )
    with pytest.raises(ArgumentError, match="low below high"):
        derive(states=x, low=[-1, -1], high=[1, 1], terms=[Term(x[0], 1, -1)], matrix=lambda t: -t * casadi.SX.eye(2))
    with pytest.raises(ArgumentError, match="at least one"):
        derive(states=x, low=[-1, -1], high=[1, 1], terms=[], matrix=lambda: -casadi.SX.eye(2))


FUNCTIONS = [
    lambda x: casadi.sin(x) * casadi.cos(2 * x) + casadi.exp(-x) * 0.3,
    lambda x: casadi.sqrt(x + 2) / (3 + x) - casadi.log(x + 2.5),
    lambda x: casadi.tanh(x) ** 3 + casadi.atan(x) * x**2 - casadi.fabs(x),
    lambda x: casadi.sinh(x) - casadi.cosh(x) + casadi.tan(0.5 * x) + casadi.asin(x / 3) - casadi.acos(x / 3),
    lambda x: 1 / (x + 3) + (x + 3) ** 0.5,
]


@given(st.integers(0, len(FUNCTIONS) - 1), st.floats(-1.0, 0.9), st.floats(0.0, 0.5), st.floats(0.0, 1.0))
def test_balls_contain_every_value(which, low, width, share) -> None:
    x = casadi.SX.sym("x")
    expression = FUNCTIONS[which](x)
    middle, radius = middles_and_radii(BallFunction(expression, x)(box_balls(np.array([low]), np.array([low + width]))))
    value = float(casadi.Function("f", [x], [expression])(low + share * width))
    assert middle[0] - radius[0] - 1e-12 <= value <= middle[0] + radius[0] + 1e-12


@pytest.mark.parametrize(("name", "ask"), [("casadi", casadi_module), ("flint", flint_module)])
def test_a_missing_package_is_named(name, ask, monkeypatch) -> None:
    monkeypatch.setitem(sys.modules, name, None)
    with pytest.raises(MissingDependencyError, match="not installed"):
        ask()


def test_switches_and_poles_have_no_enclosure() -> None:
    x = casadi.SX.sym("x")
    with pytest.raises(EnclosureError, match="switches"):
        BallFunction(casadi.if_else(x > 0, 1, x), x)
    with pytest.raises(EnclosureError, match="pole"):
        Supremum(1 / x, x).enclose(np.array([-1.0]), np.array([1.0]), np.array([[1.0]]))


@pytest.mark.parametrize(
    ("expression", "supremum"),
    [
        (lambda x: x[0] * x[1], 1.0),
        (lambda x: -(x[0] ** 2) - (x[1] - 0.3) ** 2, 0.0),
        (lambda x: casadi.cos(3 * x[0]) + x[1], 2.0),
        (lambda x: casadi.SX(0.7), 0.7),
    ],
)
def test_suprema_are_enclosed_tightly(expression, supremum) -> None:
    x = casadi.SX.sym("x", 2)
    low, high = Supremum(casadi.SX(expression(x)), x).enclose(-np.ones(2), np.ones(2), np.array([[1.0]]))
    assert low[0] <= supremum + 1e-12
    assert high[0] >= supremum - 1e-12
    assert high[0] - low[0] < 2e-6 or supremum == 0.0


def test_bounds_hold_when_the_cells_run_out() -> None:
    x = casadi.SX.sym("x", 2)
    low, high = Supremum(casadi.sin(5 * x[0]) * casadi.cos(7 * x[1]), x).enclose(
        -np.ones(2), np.ones(2), np.array([[1.0]]), cells=20
    )
    assert low[0] <= 1.0 <= high[0]
