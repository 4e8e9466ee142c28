from dataclasses import replace

import numpy as np
import pytest

from nmpc_layers.solver import BoxSolver, Motion, Outcome, TrackLimits, TrackSolver
from nmpc_layers.solver.oracle import IpoptOracle
from nmpc_layers.solver.samples import HIGH, LOW, TERMINAL, winding_problems

LIMITS = TrackLimits(half_gauge_m=0.18, track_speed_mps=0.42, acceleration_mps2=0.8, yaw_acceleration_radps2=3.0)
PERIOD_S = 1.0 / 30.0


@pytest.fixture(scope="module")
def solver():
    return TrackSolver(Motion.LAG, 15, LIMITS)


def largest_violation(commands, previous):
    tracks = np.abs(commands[:, :1] + commands[:, 1:] * LIMITS.half_gauge_m * np.array([1.0, -1.0]))
    changes = np.abs(np.diff(np.vstack([previous, commands]), axis=0)) - LIMITS.steps(PERIOD_S)
    box = np.maximum(LOW - commands, commands - HIGH)
    return max(tracks.max() - LIMITS.track_speed_mps, changes.max(), box.max())


@pytest.mark.parametrize("terminal", [None, TERMINAL])
def test_cost_equals_that_of_ipopt_and_limits_are_kept_where_they_bind(solver, terminal):
    oracle = IpoptOracle(Motion.LAG, 15, LIMITS)
    previous, closest = np.zeros(2), -np.inf
    for problem in winding_problems(Motion.LAG, 15, PERIOD_S, 40, seed=21, terminal=terminal):
        for each in (solver, oracle):
            each.start_from(problem.input_reference)
        found, judged = solver.solve(problem, previous), oracle.solve(problem, previous)
        assert found.converged and judged.converged
        assert found.cost == pytest.approx(judged.cost, abs=1e-6)
        violation = largest_violation(found.commands, previous)
        assert violation < 1e-6
        closest = max(closest, violation)
        previous = found.commands[0]
    assert closest > -1e-6


def test_without_binding_limits_the_answer_is_that_of_the_box_solver():
    wide = TrackLimits(half_gauge_m=0.18, track_speed_mps=5.0, acceleration_mps2=1e3, yaw_acceleration_radps2=1e3)
    tracks, box = TrackSolver(Motion.LAG, 15, wide), BoxSolver(Motion.LAG, 15)
    for problem in winding_problems(Motion.LAG, 15, PERIOD_S, 20, seed=22):
        for each in (tracks, box):
            each.start_from(problem.input_reference)
        assert tracks.solve(problem, np.zeros(2)).commands == pytest.approx(box.solve(problem).commands, abs=1e-4)


def test_command_in_force_outside_the_limits_has_a_way_back(solver):
    problem = winding_problems(Motion.LAG, 15, PERIOD_S, 1, seed=23)[0]
    solution = solver.solve(problem, np.array([0.5, 1.3]))
    assert solution.converged
    inside = LIMITS.nearest(np.array([0.5, 1.3]), LOW, HIGH)
    assert largest_violation(solution.commands, inside) < 1e-6


@pytest.mark.parametrize("previous", [[np.nan, 0.0], [np.inf, 0.0]])
def test_bad_command_in_force_is_an_outcome(solver, previous):
    problem = winding_problems(Motion.LAG, 15, PERIOD_S, 1, seed=24)[0]
    assert solver.solve(problem, np.array(previous)).outcome is Outcome.NON_FINITE
    assert solver.solve(problem, np.zeros(2)).converged


@pytest.mark.parametrize("value", [np.nan, np.inf, 1e200])
def test_bad_start_is_an_outcome(solver, value):
    problem = winding_problems(Motion.LAG, 15, PERIOD_S, 1, seed=24)[0]
    start = problem.start.copy()
    start[0] = value
    assert solver.solve(replace(problem, start=start), np.zeros(2)).outcome is Outcome.NON_FINITE
    assert solver.solve(problem, np.zeros(2)).converged


def test_contradicting_bounds_are_infeasible(solver):
    problem = winding_problems(Motion.LAG, 15, PERIOD_S, 1, seed=25)[0]
    low = np.tile(LOW, (15, 1))
    low[7] = [0.49, 1.29]
    assert solver.solve(replace(problem, low=low), np.zeros(2)).outcome is Outcome.INFEASIBLE


def test_interpreter_gives_what_machine_code_gives(solver):
    plain = TrackSolver(Motion.LAG, 15, LIMITS, use_compiler=False)
    for problem in winding_problems(Motion.LAG, 15, PERIOD_S, 5, seed=26):
        for each in (solver, plain):
            each.start_from(problem.input_reference)
        expected = solver.solve(problem, np.zeros(2)).commands
        assert plain.solve(problem, np.zeros(2)).commands == pytest.approx(expected, abs=1e-6)
