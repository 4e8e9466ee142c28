from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from nmpc_layers.solver import BoxSolver, Motion, Outcome, SolverCodeWarning
from nmpc_layers.solver.oracle import IpoptOracle
from nmpc_layers.solver.samples import HIGH, LOW, TERMINAL, winding_problems

SIZES = [(Motion.KINEMATIC, 10, 0.2), (Motion.LAG, 15, 1.0 / 30.0), (Motion.KINEMATIC, 15, 1.0 / 30.0)]


@pytest.fixture(scope="module")
def solvers():
    return {(motion, horizon): BoxSolver(motion, horizon) for motion, horizon, _ in SIZES}


@pytest.mark.parametrize("terminal", [None, TERMINAL])
@pytest.mark.parametrize(("motion", "horizon", "period_s"), SIZES)
def test_cost_equals_that_of_ipopt_kicks_included(solvers, motion, horizon, period_s, terminal):
    solver, oracle = solvers[motion, horizon], IpoptOracle(motion, horizon)
    for problem in winding_problems(motion, horizon, period_s, 60, seed=11, terminal=terminal):
        for each in (solver, oracle):
            each.start_from(problem.input_reference)
        found, judged = solver.solve(problem), oracle.solve(problem)
        assert found.converged and judged.converged
        assert found.cost == pytest.approx(judged.cost, abs=1e-6)


@pytest.mark.parametrize(("motion", "horizon", "period_s"), SIZES)
def test_commands_keep_their_bounds_and_states_follow_from_them(solvers, motion, horizon, period_s):
    for problem in winding_problems(motion, horizon, period_s, 30, seed=12):
        solution = solvers[motion, horizon].solve(problem)
        assert np.all(solution.commands >= LOW) and np.all(solution.commands <= HIGH)
        assert solution.states[0] == pytest.approx(problem.start)


def test_bounds_of_single_stages_are_kept(solvers):
    problem = winding_problems(Motion.LAG, 15, 1.0 / 30.0, 1, seed=13)[0]
    low, high = np.tile(LOW, (15, 1)), np.tile(HIGH, (15, 1))
    low[3], high[3] = [0.1, -0.2], [0.11, -0.1]
    solution = solvers[Motion.LAG, 15].solve(replace(problem, low=low, high=high))
    assert solution.converged
    assert np.all(solution.commands >= low) and np.all(solution.commands <= high)


@pytest.mark.parametrize(("motion", "horizon", "period_s"), SIZES)
def test_interpreter_gives_what_machine_code_gives(solvers, motion, horizon, period_s):
    interpreted = BoxSolver(motion, horizon, use_compiler=False)
    assert not interpreted.is_compiled
    for problem in winding_problems(motion, horizon, period_s, 30, seed=14):
        for each in (solvers[motion, horizon], interpreted):
            each.start_from(problem.input_reference)
        compiled, plain = solvers[motion, horizon].solve(problem), interpreted.solve(problem)
        assert plain.commands == pytest.approx(compiled.commands, abs=1e-6)
        assert plain.outcome is compiled.outcome


@pytest.mark.parametrize("field", ["start", "state_reference", "input_reference"])
@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf, 1e200])
def test_bad_numbers_are_an_outcome_and_the_next_problem_is_solved(solvers, field, value):
    solver = solvers[Motion.LAG, 15]
    good = winding_problems(Motion.LAG, 15, 1.0 / 30.0, 1, seed=15)[0]
    table = getattr(good, field).copy()
    table.flat[1] = value
    bad = solver.solve(replace(good, **{field: table}))
    assert bad.outcome is Outcome.NON_FINITE
    assert np.all(bad.commands == 0.0)
    assert solver.solve(good).converged


def test_bad_parameter_is_an_outcome(solvers):
    problem = winding_problems(Motion.LAG, 15, 1.0 / 30.0, 1, seed=15)[0]
    spoiled = replace(problem, parameters=replace(problem.parameters, yaw_slip_radps=float("nan")))
    assert solvers[Motion.LAG, 15].solve(spoiled).outcome is Outcome.NON_FINITE


@settings(max_examples=60, derandomize=True, deadline=None)
@given(numbers=st.lists(st.floats(allow_nan=True, allow_infinity=True), min_size=5, max_size=5))
def test_any_start_gives_finite_commands_within_bounds(solvers, numbers):
    problem = winding_problems(Motion.LAG, 15, 1.0 / 30.0, 1, seed=16)[0]
    commands = solvers[Motion.LAG, 15].solve(replace(problem, start=np.array(numbers))).commands
    assert np.isfinite(commands).all()
    assert np.all(commands >= LOW) and np.all(commands <= HIGH)


def test_iteration_limit_is_an_outcome():
    solver = BoxSolver(Motion.KINEMATIC, 10, iteration_limit=1)
    assert solver.solve(winding_problems(Motion.KINEMATIC, 10, 0.2, 1, seed=17)[0]).outcome is Outcome.ITERATION_LIMIT


def test_solution_survives_the_next_solve(solvers):
    solver = solvers[Motion.KINEMATIC, 10]
    first, second = winding_problems(Motion.KINEMATIC, 10, 0.2, 30, seed=18)[::29]
    solution = solver.solve(first)
    kept = solution.commands.copy()
    solver.solve(second)
    assert np.array_equal(solution.commands, kept)


def test_shifted_guess_saves_iterations(solvers):
    solver = solvers[Motion.KINEMATIC, 10]
    first, second = winding_problems(Motion.KINEMATIC, 10, 0.2, 8, seed=19)[5:7]
    solver.solve(first)
    solver.shift(1)
    warm = solver.solve(second).iterations
    solver.start_from(np.zeros((10, 2)))
    assert warm <= solver.solve(second).iterations


def test_shift_beyond_the_horizon_repeats_the_last_command(solvers):
    solver = solvers[Motion.KINEMATIC, 10]
    solver.start_from(np.arange(20.0).reshape(10, 2))
    solver.shift(10**9)
    problem = winding_problems(Motion.KINEMATIC, 10, 0.2, 1, seed=20)[0]
    assert solver.solve(problem).converged


def test_horizon_of_one_step_is_refused():
    with pytest.raises(ValueError, match="horizon"):
        BoxSolver(Motion.KINEMATIC, 1)


def test_without_compiler_the_interpreter_stands_in_and_says_so(tmp_path, monkeypatch):
    monkeypatch.setenv("TRACKED_CACHE_DIR", str(tmp_path))
    monkeypatch.delenv("CC", raising=False)
    monkeypatch.setenv("PATH", "")
    with pytest.warns(SolverCodeWarning, match="no C compiler"):
        solver = BoxSolver(Motion.KINEMATIC, 4)
    assert not solver.is_compiled
    assert "apt install gcc" in solver.interpreter_reason
