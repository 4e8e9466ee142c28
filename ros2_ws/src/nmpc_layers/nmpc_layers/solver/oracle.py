"""The same problem by an interior-point method: slow, independent, the judge of the other solvers."""

from typing import Any

import casadi
import numpy as np
from numpy.typing import NDArray

from nmpc_layers.solver.motion_model import PARAMETER_COUNT, Motion, next_state
from nmpc_layers.solver.problem import Problem
from nmpc_layers.solver.solution import Outcome, Solution
from nmpc_layers.solver.terminal_weight import weighed
from nmpc_layers.solver.track_solver import TrackLimits
from nmpc_layers.solver.weights import STAGE_COUNT, WEIGHT_COUNT

Array = NDArray[np.float64]
Expression = Any


class IpoptOracle:
    """IPOPT on the multiple-shooting form, one step of the model per stage.

    Parameters
    ----------
    motion, horizon: structure of the problem.
    limits: track-speed and rate limits, or None for the box alone.
    tolerance: IPOPT's ``tol``.
    """

    def __init__(
        self, motion: Motion, horizon: int, limits: TrackLimits | None = None, *, tolerance: float = 1e-10
    ) -> None:
        self.motion, self.horizon, self.limits = motion, horizon, limits
        symbol, count = casadi.SX.sym, motion.state_count
        states, commands = symbol("states", count, horizon + 1), symbol("commands", 2, horizon)
        start, previous = symbol("start", count), symbol("previous", 2)
        reference, targets = symbol("reference", 3, horizon + 1), symbol("targets", 2, horizon)
        parameters, weights = symbol("parameters", PARAMETER_COUNT), symbol("weights", WEIGHT_COUNT)

        cost, defects = casadi.SX(0), [states[:, 0] - start]
        for stage in range(horizon):
            arrived = next_state(motion, states[:, stage], commands[:, stage], parameters)
            defects.append(states[:, stage + 1] - arrived)
            cost += casadi.dot(weights[:3], (states[:3, stage] - reference[:, stage]) ** 2)
            cost += casadi.dot(weights[3:5], (commands[:, stage] - targets[:, stage]) ** 2)
        cost += weighed(weights[STAGE_COUNT:], states[:3, horizon] - reference[:, horizon])
        constraints = list(defects)
        if limits is not None:
            rows = casadi.DM(limits.rows(horizon)) @ casadi.vec(commands)
            rows[2 * horizon : 2 * horizon + 2] -= previous
            constraints.append(rows)
        problem: dict[str, Expression] = {
            "x": casadi.vertcat(casadi.vec(states), casadi.vec(commands)),
            "p": casadi.vertcat(start, casadi.vec(reference), casadi.vec(targets), parameters, weights, previous),
            "f": cost,
            "g": casadi.vertcat(*constraints),
        }
        # Bounds are relaxed by nothing: the judge keeps them exactly.
        options: dict[str, Any] = {"print_time": 0, "ipopt.print_level": 0, "ipopt.sb": "yes", "ipopt.tol": tolerance}
        options["ipopt.bound_relax_factor"] = 0.0
        self._solver = casadi.nlpsol("oracle", "ipopt", problem, options)
        self._guess = np.zeros((horizon, 2))

    def start_from(self, guess: Array) -> None:
        """Set the commands (N, 2) from which the next solve starts."""
        self._guess[:] = guess

    def solve(self, problem: Problem, previous: Array | None = None) -> Solution:
        """Solve from the current guess; ``previous`` as in `TrackSolver.solve`."""
        horizon, count = self.horizon, self.motion.state_count
        low = np.broadcast_to(problem.low, (horizon, 2)).ravel()
        high = np.broadcast_to(problem.high, (horizon, 2)).ravel()
        origin = np.zeros(2)
        extra_low = extra_high = np.zeros(0)
        if self.limits is not None and previous is not None:
            origin = self.limits.nearest(previous, low[:2], high[:2])
            tracks = np.full(2 * horizon, self.limits.track_speed_mps)
            extra_high = np.concatenate([tracks, np.tile(self.limits.steps(problem.parameters.period_s), horizon)])
            extra_low = -extra_high
        zeros, free = np.zeros(count * (horizon + 1)), np.full(count * (horizon + 1), np.inf)
        poses = np.zeros((horizon + 1, count))
        poses[:, :3] = problem.state_reference
        result = self._solver(
            x0=np.concatenate([poses.ravel(), self._guess.ravel()]),
            p=np.concatenate(
                [
                    *(problem.start, problem.state_reference.ravel(), problem.input_reference.ravel()),
                    *(problem.parameters.as_array(), problem.weight_array(), origin),
                ]
            ),
            lbx=np.concatenate([-free, low]),
            ubx=np.concatenate([free, high]),
            lbg=np.concatenate([zeros, extra_low]),
            ubg=np.concatenate([zeros, extra_high]),
        )
        found = result["x"].full().ravel()
        statistics = self._solver.stats()
        return Solution(
            found[zeros.size :].reshape(horizon, 2),
            found[: zeros.size].reshape(horizon + 1, count),
            float(result["f"]),
            int(statistics["iter_count"]),
            Outcome.CONVERGED if statistics["success"] else Outcome.STALLED,
        )
