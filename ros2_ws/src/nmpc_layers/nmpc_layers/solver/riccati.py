"""One iteration of the control-limited Gauss-Newton method, as a CasADi function of the problem.

A backward Riccati sweep with an exact box QP per stage (Tassa, Mansard, Todorov: Control-limited
differential dynamic programming, ICRA 2014) on the Gauss-Newton model of the cost, then roll-outs with
decreasing step sizes, of which the shorter ones are computed only if the full one does not lower the cost.
Work and memory grow linearly with the horizon.
"""

from typing import Any

import casadi

from nmpc_layers.solver.motion_model import PARAMETER_COUNT, Motion
from nmpc_layers.solver.stage_functions import StageFunctions, upper_triangle
from nmpc_layers.solver.terminal_weight import unpacked, weighed
from nmpc_layers.solver.weights import STAGE_COUNT, WEIGHT_COUNT

Expression = Any
Function = Any

SHORTER_STEPS = (0.5, 0.2, 0.05, 0.01)
INPUT_NAMES = ["start", "commands", "state_reference", "input_reference", "parameters", "weights", "bounds"]
OUTPUT_NAMES = ["new_commands", "new_cost", "old_cost", "change", "expected", "states"]


def riccati_iteration(motion: Motion, horizon: int) -> Function:
    """Build the iteration for ``horizon`` stages.

    Inputs: start (n,), commands (2, N), state_reference (3, N+1), input_reference (2, N),
    parameters (8,), weights (11,), bounds (4, N): low then high of each stage's command, to which the given
    commands are clipped first.
    Outputs: new_commands (2, N); their cost; the old cost; the largest change of a command; the cost
    change that the quadratic model expected (not positive); states (n, N+1) of the new commands.
    """
    stages = StageFunctions.build(motion)
    count = motion.state_count
    start = casadi.MX.sym("start", count)
    guess = casadi.MX.sym("commands", 2, horizon)
    state_reference = casadi.MX.sym("state_reference", 3, horizon + 1)
    input_reference = casadi.MX.sym("input_reference", 2, horizon)
    parameters = casadi.MX.sym("parameters", PARAMETER_COUNT)
    weights = casadi.MX.sym("weights", WEIGHT_COUNT)
    bounds = casadi.MX.sym("bounds", 4, horizon)
    commands = casadi.fmin(casadi.fmax(guess, bounds[:2, :]), bounds[2:, :])
    all_parameters = casadi.repmat(parameters, 1, horizon)
    all_weights = casadi.repmat(weights, 1, horizon)

    rolled = stages.plain.mapaccum(horizon)(
        casadi.vertcat(start, 0), commands, state_reference[:, :-1], input_reference, all_parameters, all_weights
    )
    states = casadi.horzcat(start, rolled[:count, :])
    old_cost = rolled[count, -1] + _terminal_cost(rolled[:3, -1], state_reference[:, -1], weights)

    backwards = list(range(horizon - 1, -1, -1))
    swept, changes, gains = stages.sweep.mapaccum(horizon)(
        _terminal_value(motion, states[:3, -1], state_reference[:, -1], weights),
        *(table[:, backwards] for table in (states, commands, state_reference[:, :-1], input_reference)),
        all_parameters,
        all_weights,
        bounds[:, backwards],
    )
    expected = swept[-1, -1]

    # What a roll-out needs beside its step size; the same list serves the conditional function below.
    tables = [
        *(start, commands, states[:, :-1], changes[:, backwards], gains[:, backwards]),
        *(state_reference, input_reference, parameters, weights, bounds),
    ]
    attempt = _roll_out(stages.feedback, motion, horizon)
    full = attempt(1.0, *tables)
    search = _shorter_steps(attempt, tables)
    keep = casadi.Function("keep", search.mx_in(), search.mx_in()[:3])
    chosen = casadi.Function.if_else("choose", keep, search)(full[1] < old_cost, *full, states, old_cost, *tables)
    change = casadi.mmax(casadi.fabs(chosen[0] - commands))
    return casadi.Function(
        f"riccati_{motion.value}_{horizon}",
        [start, guess, state_reference, input_reference, parameters, weights, bounds],
        [chosen[0], chosen[1], old_cost, change, expected, chosen[2]],
        INPUT_NAMES,
        OUTPUT_NAMES,
    )


def _terminal_cost(pose: Expression, reference: Expression, weights: Expression) -> Expression:
    return weighed(weights[STAGE_COUNT:], pose - reference)


def _terminal_value(motion: Motion, pose: Expression, reference: Expression, weights: Expression) -> Expression:
    """Value function of the last state, packed as `StageFunctions.sweep` carries it."""
    last = weights[STAGE_COUNT:]
    of_pose = {place: 2 * last[index] for index, place in enumerate(upper_triangle(3))}
    packed = [of_pose.get(place, casadi.MX(0)) for place in upper_triangle(motion.state_count)]
    gradient = 2 * unpacked(last) @ (pose - reference)
    return casadi.vertcat(*packed, gradient, casadi.MX.zeros(motion.state_count - 3), 0)


def _roll_out(feedback: Function, motion: Motion, horizon: int) -> Function:
    """Function of (step size, tables) -> (commands, cost, states) that follows the sweep's feedback law."""
    count = motion.state_count
    size = casadi.MX.sym("size")
    start = casadi.MX.sym("start", count)
    tables = [
        casadi.MX.sym("commands", 2, horizon),
        casadi.MX.sym("states", count, horizon),
        casadi.MX.sym("changes", 2, horizon),
        casadi.MX.sym("gains", 2 * count, horizon),
    ]
    state_reference = casadi.MX.sym("state_reference", 3, horizon + 1)
    input_reference = casadi.MX.sym("input_reference", 2, horizon)
    parameters = casadi.MX.sym("parameters", PARAMETER_COUNT)
    weights = casadi.MX.sym("weights", WEIGHT_COUNT)
    bounds = casadi.MX.sym("bounds", 4, horizon)
    rolled, commands = feedback.mapaccum(horizon)(
        casadi.vertcat(start, 0),
        *tables,
        state_reference[:, :-1],
        input_reference,
        *(casadi.repmat(column, 1, horizon) for column in (parameters, weights)),
        bounds,
        casadi.repmat(size, 1, horizon),
    )
    cost = rolled[count, -1] + _terminal_cost(rolled[:3, -1], state_reference[:, -1], weights)
    return casadi.Function(
        "roll_out",
        [size, start, *tables, state_reference, input_reference, parameters, weights, bounds],
        [commands, cost, casadi.horzcat(start, rolled[:count, :])],
    )


def _shorter_steps(attempt: Function, tables: list[Expression]) -> Function:
    """Function (commands, cost, states of the full step; old states, old cost; tables) -> the best shorter step."""
    full = [casadi.MX.sym("full", attempt.sparsity_out(index)) for index in range(3)]
    old_states = casadi.MX.sym("old_states", attempt.sparsity_out(2))
    old_cost = casadi.MX.sym("old_cost")
    symbols = [casadi.MX.sym("table", table.sparsity()) for table in tables]
    best = [symbols[1], old_cost, old_states]
    for size in SHORTER_STEPS:
        tried = attempt(size, *symbols)
        better = tried[1] < best[1]
        best = [casadi.if_else(better, new, kept) for new, kept in zip(tried, best, strict=True)]
    return casadi.Function("search", [*full, old_states, old_cost, *symbols], best)
