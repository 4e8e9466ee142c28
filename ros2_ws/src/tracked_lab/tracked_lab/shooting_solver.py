"""The layers' problem in multiple-shooting form, by the solvers that come with CasADi."""

from typing import Any

import casadi
import numpy as np
from numpy.typing import NDArray

from nmpc_layers.solver import Motion, Problem
from nmpc_layers.solver.motion_model import PARAMETER_COUNT, next_state

Array = NDArray[np.float64]


class ShootingSolver:
    """Solver ``kind``: fatrop, or sqpmethod with qrqp and Gauss-Newton's Hessian."""

    def __init__(self, kind: str, horizon: int) -> None:
        symbol = casadi.SX.sym
        states = [symbol(f"x{stage}", 3) for stage in range(horizon + 1)]
        commands = [symbol(f"u{stage}", 2) for stage in range(horizon)]
        start, references = symbol("start", 3), symbol("references", 3, horizon + 1)
        targets, parameters, weights = (
            symbol("targets", 2, horizon),
            symbol("parameters", PARAMETER_COUNT),
            symbol("weights", 5),
        )
        residuals, gaps, variables = [], [states[0] - start], []
        for stage in range(horizon + 1):
            grown = weights[4] if stage == horizon else 1.0
            root = casadi.sqrt(grown * casadi.vertcat(weights[0], weights[0], weights[1]))
            residuals.append(root * (states[stage] - references[:, stage]))
            variables.append(states[stage])
            if stage < horizon:
                residuals.append(casadi.sqrt(weights[2:4]) * (commands[stage] - targets[:, stage]))
                variables.append(commands[stage])
                following = next_state(Motion.KINEMATIC, states[stage], commands[stage], parameters)
                gaps.append(states[stage + 1] - following)
        residual, unknowns = casadi.vertcat(*residuals), casadi.vertcat(*variables)
        cost = casadi.sumsqr(residual)
        nlp = {
            "x": unknowns,
            "p": casadi.vertcat(start, casadi.vec(references), casadi.vec(targets), parameters, weights),
            "f": cost,
            "g": casadi.vertcat(*gaps),
        }
        options: dict[str, Any] = {"print_time": 0}
        if kind == "fatrop":
            options |= {"structure_detection": "auto", "equality": [True] * (3 * (horizon + 1))}
            options |= {"fatrop.print_level": 0, "fatrop.tol": 1e-6}
        else:
            by = casadi.jacobian(residual, unknowns)
            factor, multipliers = symbol("factor"), symbol("multipliers", 3 * (horizon + 1))
            triangle = casadi.triu(2 * factor * by.T @ by)
            hessian = casadi.Function("hessian", [unknowns, nlp["p"], factor, multipliers], [triangle])
            quiet = {"print_iter": False, "print_header": False, "print_info": False, "error_on_fail": False}
            options |= {"qpsol": "qrqp", "qpsol_options": quiet, "hess_lag": hessian}
            options |= {"print_header": False, "print_iteration": False, "print_status": False}
        self._solver = casadi.nlpsol("peer", "fatrop" if kind == "fatrop" else "sqpmethod", nlp, options)
        self._horizon = horizon
        self._guess = np.zeros((horizon, 2))

    def start_from(self, guess: Array) -> None:
        """Commands (N, 2) from which the next solve starts."""
        self._guess = np.array(guess)

    def solve(self, problem: Problem) -> float:
        """The cost that was reached."""
        horizon, weights = self._horizon, problem.weights
        low, high = np.full(5 * horizon + 3, -np.inf), np.full(5 * horizon + 3, np.inf)
        guess = np.zeros(5 * horizon + 3)
        for stage in range(horizon + 1):
            guess[5 * stage : 5 * stage + 3] = problem.state_reference[stage]
            if stage < horizon:
                inputs = slice(5 * stage + 3, 5 * stage + 5)
                low[inputs], high[inputs], guess[inputs] = problem.low, problem.high, self._guess[stage]
        numbers = [weights.position, weights.heading, weights.speed, weights.yaw_rate, weights.terminal]
        table = [problem.start, problem.state_reference.ravel(), problem.input_reference.ravel()]
        found = self._solver(
            x0=guess,
            p=np.concatenate([*table, problem.parameters.as_array(), numbers]),
            lbx=low,
            ubx=high,
            lbg=0.0,
            ubg=0.0,
        )
        return float(found["f"])
