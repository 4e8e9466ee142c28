import casadi
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from nmpc_layers.solver.box_quadratic import minimise_in_box


@pytest.fixture(scope="module")
def solve():
    hessian, gradient = casadi.SX.sym("hessian", 2, 2), casadi.SX.sym("gradient", 2)
    low, high = casadi.SX.sym("low", 2), casadi.SX.sym("high", 2)
    step, free = minimise_in_box(hessian, gradient, low, high)
    return casadi.Function("box", [hessian, gradient, low, high], [step, free])


numbers = st.floats(-5.0, 5.0)
positive = st.floats(0.1, 5.0)


@settings(max_examples=200, derandomize=True, deadline=None)
@given(
    first=positive,
    second=positive,
    coupling=st.floats(-0.95, 0.95),
    gradient=st.tuples(numbers, numbers),
    low=st.tuples(numbers, numbers),
    width=st.tuples(positive, positive),
)
def test_no_point_of_the_box_is_lower(solve, first, second, coupling, gradient, low, width):
    cross = coupling * np.sqrt(first * second)
    hessian = np.array([[first, cross], [cross, second]])
    high = np.add(low, width)
    step, _ = (output.full().ravel() for output in solve(hessian, gradient, low, high))
    assert np.all(step >= np.array(low) - 1e-12) and np.all(step <= high + 1e-12)

    # Optimality of a convex problem: a projected gradient step leads nowhere.
    slope = hessian @ step + gradient
    assert np.clip(step - slope, low, high) == pytest.approx(step, abs=1e-8)


def test_component_at_its_bound_is_not_free(solve):
    step, free = (output.full().ravel() for output in solve(np.eye(2), [-9.0, -0.5], [-1.0, -1.0], [1.0, 1.0]))
    assert step == pytest.approx([1.0, 0.5]) and free == pytest.approx([0.0, 1.0])
