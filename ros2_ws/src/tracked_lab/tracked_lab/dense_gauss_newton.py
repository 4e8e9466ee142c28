"""The layers' problem solved the dense way, as in the thesis's time measurements (Fig 5.13).

The textbook's form: all commands at once, the sensitivities of every pose to every command and the weights of all
stages as full matrices, and each Gauss-Newton step a dense quadratic program. Its work grows with the square to the
cube of the horizon.
"""

from typing import Any

import daqp
import numpy as np
from numpy.typing import NDArray

from nmpc_layers.solver import Problem

Array = NDArray[np.float64]
_ITERATIONS, _HALVINGS, _TOLERANCE = 10, 5, 1e-5


class DenseGaussNewton:
    """For poses moved by speed and yaw rate (``Motion.KINEMATIC``) without slip."""

    def __init__(self, horizon: int) -> None:
        self._horizon = horizon
        self._guess = np.zeros((horizon, 2))
        self._sense = np.zeros(2 * horizon, dtype=np.int32)

    def start_from(self, guess: Array) -> None:
        """Commands (N, 2) from which the next solve starts."""
        self._guess = np.array(guess)

    def solve(self, problem: Problem) -> float:
        """The cost that was reached."""
        commands = np.clip(self._guess, problem.low, problem.high)
        states, cost = self._rolled_out(problem, commands)
        for _ in range(_ITERATIONS):
            step = self._step(problem, commands, states)
            share = 1.0
            for _ in range(_HALVINGS):
                new_states, new_cost = self._rolled_out(problem, commands + share * step)
                if new_cost <= cost:
                    break
                share *= 0.5
            commands, states, cost = commands + share * step, new_states, new_cost
            if np.abs(share * step).max() < _TOLERANCE:
                break
        return cost

    def _rolled_out(self, problem: Problem, commands: Array) -> tuple[Array, float]:
        period, point = problem.parameters.period_s, problem.parameters.heading_point
        states = np.empty((self._horizon + 1, 3))
        states[0] = problem.start
        for stage in range(self._horizon):
            speed, rate = commands[stage]
            heading = states[stage, 2] + point * period * rate
            moved = period * np.array([speed * np.cos(heading), speed * np.sin(heading), rate])
            states[stage + 1] = states[stage] + moved
        errors = states - problem.state_reference
        weights = problem.weights
        pose = np.array([weights.position, weights.position, weights.heading])
        cost = float((pose * errors[:-1] ** 2).sum() + weights.terminal * (pose * errors[-1] ** 2).sum())
        inputs = np.array([weights.speed, weights.yaw_rate])
        return states, cost + float((inputs * (commands - problem.input_reference) ** 2).sum())

    def _step(self, problem: Problem, commands: Array, states: Array) -> Array:
        horizon, period, point = self._horizon, problem.parameters.period_s, problem.parameters.heading_point
        sensitivity = np.zeros((3 * horizon, 2 * horizon))
        for stage in range(horizon):
            speed, rate = commands[stage]
            heading = states[stage, 2] + point * period * rate
            cosine, sine = np.cos(heading), np.sin(heading)
            rows = slice(3 * stage, 3 * stage + 3)
            if stage:
                carry = np.eye(3)
                carry[0, 2], carry[1, 2] = -period * sine * speed, period * cosine * speed
                sensitivity[rows, : 2 * stage] = carry @ sensitivity[3 * stage - 3 : 3 * stage, : 2 * stage]
            bend = point * period * period * speed
            sensitivity[rows, 2 * stage : 2 * stage + 2] = [
                [period * cosine, -bend * sine],
                [period * sine, bend * cosine],
                [0.0, period],
            ]
        weights = problem.weights
        pose = 2.0 * np.array([weights.position, weights.position, weights.heading])
        diagonal = np.concatenate([np.tile(pose, horizon - 1), weights.terminal * pose])
        inputs = 2.0 * np.tile([weights.speed, weights.yaw_rate], horizon)
        errors = (states[1:] - problem.state_reference[1:]).ravel()
        hessian = sensitivity.T @ np.diag(diagonal) @ sensitivity + np.diag(inputs)
        gradient = sensitivity.T @ (diagonal * errors) + inputs * (commands - problem.input_reference).ravel()
        upper = np.ascontiguousarray((problem.high - commands).ravel())
        lower = np.ascontiguousarray((problem.low - commands).ravel())
        found: Any = daqp.solve(hessian, gradient, np.zeros((0, 2 * horizon)), upper, lower, self._sense)
        step: Array = np.asarray(found[0]).reshape(-1, 2)
        return step
