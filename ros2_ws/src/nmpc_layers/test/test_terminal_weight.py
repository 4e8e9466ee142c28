import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nmpc_layers.solver import BoxSolver, Motion, Outcome, TerminalWeight, Weights
from nmpc_layers.solver.samples import TERMINAL, winding_problems
from nmpc_layers.solver.weights import STAGE_COUNT


def turned(matrix, heading):
    c, s = math.cos(heading), math.sin(heading)
    rotation = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    return rotation @ matrix @ rotation.T


@given(heading=st.floats(-20.0, 20.0))
def test_weight_turns_with_the_reference(heading):
    assert TerminalWeight(tuple(TERMINAL.in_world(heading).tolist())).matrix == pytest.approx(
        turned(TERMINAL.matrix, heading), abs=1e-9
    )


def test_diagonal_of_equal_axes_is_what_the_factor_gives():
    weights = Weights(position=20.0, heading=2.0, speed=1.0, yaw_rate=0.5, terminal=5.0)
    same = TerminalWeight.of(np.diag([100.0, 100.0, 10.0]))
    assert weights.as_array()[STAGE_COUNT:] == pytest.approx(same.in_world(0.7), abs=1e-12)


@pytest.mark.parametrize("motion", [Motion.KINEMATIC, Motion.LAG])
def test_answer_does_not_depend_on_where_north_is(motion):
    solver, turn = BoxSolver(motion, 10, use_compiler=False), 2.1
    c, s = math.cos(turn), math.sin(turn)
    for problem in winding_problems(motion, 10, 0.2, 5, seed=3, terminal=TERMINAL):
        start, reference = problem.start.copy(), problem.state_reference.copy()
        for table in (start, reference):
            x, y = table[..., 0].copy(), table[..., 1].copy()
            table[..., 0], table[..., 1] = c * x - s * y, s * x + c * y
            table[..., 2] += turn
        solver.start_from(problem.input_reference)
        plain = solver.solve(problem)
        solver.start_from(problem.input_reference)
        rotated = solver.solve(replace(problem, start=start, state_reference=reference))
        assert rotated.commands == pytest.approx(plain.commands, abs=1e-7)
        assert rotated.cost == pytest.approx(plain.cost, abs=1e-9)


@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_heading_that_is_not_finite_is_an_outcome(value):
    problem = winding_problems(Motion.KINEMATIC, 10, 0.2, 1, seed=3, terminal=TERMINAL)[0]
    reference = problem.state_reference.copy()
    reference[-1, 2] = value
    solver = BoxSolver(Motion.KINEMATIC, 10, use_compiler=False)
    assert solver.solve(replace(problem, state_reference=reference)).outcome is Outcome.NON_FINITE


@pytest.mark.parametrize(
    "matrix",
    [
        np.eye(2),
        np.diag([1.0, 1.0, -1.0]),
        np.triu(np.ones((3, 3))),
        np.full((3, 3), np.nan),
    ],
)
def test_what_is_no_weight_is_refused(matrix):
    with pytest.raises(ValueError, match="terminal weight"):
        TerminalWeight.of(matrix)
