"""What the control-limited Gauss-Newton method does in one stage, as CasADi functions."""

from dataclasses import dataclass
from typing import Any

import casadi

from nmpc_layers.solver.box_quadratic import minimise_in_box
from nmpc_layers.solver.motion_model import PARAMETER_COUNT, Motion, next_state
from nmpc_layers.solver.weights import WEIGHT_COUNT

Expression = Any
Function = Any


def upper_triangle(count: int) -> list[tuple[int, int]]:
    """Row and column of the entries that a packed symmetric matrix holds, row by row."""
    return [(row, column) for row in range(count) for column in range(row, count)]


@dataclass(frozen=True)
class StageFunctions:
    """Functions of one stage, mapped over the horizon by loops in the generated code.

    plain: (state and cost so far, command, ...) -> the same one stage later. sweep: backward, see `_sweep`.
    feedback: like plain, with the command that the sweep's feedback law gives, as second output.
    """

    plain: Function
    sweep: Function
    feedback: Function

    @classmethod
    def build(cls, motion: Motion) -> "StageFunctions":
        """The functions for one structure of model."""
        symbol = casadi.SX.sym
        count = motion.state_count
        state, command = symbol("state", count), symbol("command", 2)
        reference, target = symbol("reference", 3), symbol("target", 2)
        parameters, weights = symbol("parameters", PARAMETER_COUNT), symbol("weights", WEIGHT_COUNT)
        bounds, cost = symbol("bounds", 4), symbol("cost")

        def stage_cost(applied: Expression) -> Expression:
            pose_error = casadi.dot(weights[:3], (state[:3] - reference) ** 2)
            return pose_error + casadi.dot(weights[3:5], (applied - target) ** 2)

        def advance(applied: Expression) -> Expression:
            return casadi.vertcat(next_state(motion, state, applied, parameters), cost + stage_cost(applied))

        carried = casadi.vertcat(state, cost)
        plain = casadi.Function("plain", [carried, command, reference, target, parameters, weights], [advance(command)])

        old_state, change, size = symbol("old_state", count), symbol("change", 2), symbol("size")
        gain = symbol("gain", 2 * count)
        applied = command + size * change + casadi.reshape(gain, 2, count) @ (state - old_state)
        applied = casadi.fmin(casadi.fmax(applied, bounds[:2]), bounds[2:])
        feedback = casadi.Function(
            "feedback",
            [carried, command, old_state, change, gain, reference, target, parameters, weights, bounds, size],
            [advance(applied), applied],
        )
        return cls(plain, _sweep(motion), feedback)


def _sweep(motion: Motion) -> Function:
    """Backward stage: value function after -> value function before, command change and feedback gain.

    The value function travels as its Hessian's upper triangle, its gradient and the expected cost change.
    """
    symbol = casadi.SX.sym
    count = motion.state_count
    state, command = symbol("state", count), symbol("command", 2)
    reference, target = symbol("reference", 3), symbol("target", 2)
    parameters, weights, bounds = symbol("parameters", PARAMETER_COUNT), symbol("weights", WEIGHT_COUNT), symbol("b", 4)
    triangle = upper_triangle(count)
    packed = symbol("hessian", len(triangle))
    gradient, expected = symbol("gradient", count), symbol("expected")
    hessian = casadi.SX(count, count)
    for index, (row, column) in enumerate(triangle):
        hessian[row, column] = packed[index]
        hessian[column, row] = packed[index]

    following = next_state(motion, state, command, parameters)
    by_state, by_command = casadi.jacobian(following, state), casadi.jacobian(following, command)
    padding = casadi.SX.zeros(count - 3)
    state_gradient = casadi.vertcat(2 * weights[:3] * (state[:3] - reference), padding) + by_state.T @ gradient
    command_gradient = 2 * weights[3:5] * (command - target) + by_command.T @ gradient
    carried_over = hessian @ by_state
    state_hessian = casadi.diag(casadi.vertcat(2 * weights[:3], padding)) + by_state.T @ carried_over
    mixed = by_command.T @ carried_over
    command_hessian = casadi.diag(2 * weights[3:5]) + by_command.T @ (hessian @ by_command)

    change, free = minimise_in_box(command_hessian, command_gradient, bounds[:2] - command, bounds[2:] - command)
    gain = _feedback_gain(command_hessian, mixed, free)
    value_gradient = state_gradient + gain.T @ (command_hessian @ change + command_gradient) + mixed.T @ change
    coupling = gain.T @ mixed
    value_hessian = state_hessian + gain.T @ command_hessian @ gain + coupling + coupling.T
    gained = casadi.dot(command_gradient, change) + casadi.dot(change, command_hessian @ change) / 2
    before = casadi.vertcat(*(value_hessian[row, column] for row, column in triangle), value_gradient)
    return casadi.Function(
        "sweep",
        [
            casadi.vertcat(packed, gradient, expected),
            *(state, command, reference, target, parameters, weights, bounds),
        ],
        [casadi.vertcat(before, expected + gained), change, casadi.vec(gain)],
    )


def _feedback_gain(command_hessian: Expression, mixed: Expression, free: Expression) -> Expression:
    """Gain (2, n) on the state error; a component that its bound holds does not react."""
    first, cross, second = command_hessian[0, 0], command_hessian[0, 1], command_hessian[1, 1]
    determinant = first * second - cross * cross
    both = -casadi.vertcat(second * mixed[0, :] - cross * mixed[1, :], first * mixed[1, :] - cross * mixed[0, :])
    single = casadi.vertcat(-mixed[0, :] / first * free[0], -mixed[1, :] / second * free[1])
    return casadi.if_else(free[0] * free[1], both / determinant, single)
