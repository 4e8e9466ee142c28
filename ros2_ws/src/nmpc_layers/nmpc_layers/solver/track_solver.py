"""Solver of the problem with track-speed and rate limits on the commands (erratum 5.2.5)."""

import math
from dataclasses import dataclass

import daqp
import numpy as np
from numpy.typing import NDArray

from casadi_code import FunctionBuffer, compiled
from nmpc_layers.solver.condensing import condensed_cost
from nmpc_layers.solver.motion_model import Motion
from nmpc_layers.solver.problem import Problem
from nmpc_layers.solver.solution import Outcome, Solution
from nmpc_layers.solver.warm_start import WarmStart

Array = NDArray[np.float64]

FEASIBILITY_TOLERANCE = 1e-9
SMALLEST_STEP = 1e-3


@dataclass(frozen=True, slots=True)
class TrackLimits:
    """Limits that couple speed and yaw rate, or one stage and the next.

    half_gauge_m: d of (5.2.2). track_speed_mps: bound of ``|v + d w|`` and ``|v - d w|``.
    acceleration_mps2, yaw_acceleration_radps2: bounds of the commands' change per second.
    """

    half_gauge_m: float
    track_speed_mps: float
    acceleration_mps2: float
    yaw_acceleration_radps2: float

    def rows(self, horizon: int) -> Array:
        """Constraint matrix (4N, 2N) on the stacked commands: 2N track speeds, then 2N changes."""
        size = 2 * horizon
        tracks = np.kron(np.eye(horizon), [[1.0, self.half_gauge_m], [1.0, -self.half_gauge_m]])
        return np.ascontiguousarray(np.vstack([tracks, np.eye(size) - np.eye(size, k=-2)]))

    def steps(self, period_s: float) -> Array:
        """Largest change of speed and yaw rate from one stage to the next, shape (2,)."""
        return np.array([self.acceleration_mps2 * period_s, self.yaw_acceleration_radps2 * period_s])

    def nearest(self, command: Array, low: Array, high: Array) -> Array:
        """A command (2,) near the given one that keeps box and track limits: a turn keeps its share."""
        speed, yaw_rate = np.clip(command, low, high).tolist()
        excess = max((abs(speed) + self.half_gauge_m * abs(yaw_rate)) / self.track_speed_mps, 1.0)
        return np.array([speed / excess, yaw_rate / excess])


class TrackSolver(WarmStart):
    """Condensed Gauss-Newton method with an active-set QP for one structure of model and one horizon.

    Parameters
    ----------
    motion, horizon: structure of the problem.
    limits: limits beside the problem's box.
    iteration_limit, tolerance, use_compiler: as in `BoxSolver`.
    """

    def __init__(
        self,
        motion: Motion,
        horizon: int,
        limits: TrackLimits,
        *,
        iteration_limit: int = 30,
        tolerance: float = 1e-9,
        use_compiler: bool = True,
    ) -> None:
        super().__init__(motion, horizon)
        self.limits = limits
        function = condensed_cost(motion, horizon)
        self.interpreter_reason = "" if use_compiler else "not asked to compile"
        if use_compiler:
            function, self.interpreter_reason = compiled(function)
        self._buffer = FunctionBuffer(function)
        self._rows = limits.rows(horizon)
        self._model: daqp.Model | None = None
        self._iteration_limit, self._tolerance = iteration_limit, tolerance

    def solve(self, problem: Problem, previous: Array) -> Solution:
        """Solve from the current guess, ``previous`` (2,) being the command in force before the first stage.

        A ``previous`` outside box and track limits counts as the nearest command inside, so that there is
        always a way on. Never raises for bad numbers: the outcome tells.
        """
        if not problem.is_finite() or not np.isfinite(previous).all():
            return self._failure(Outcome.NON_FINITE, 0)
        self._load(problem)
        high, low = self._bounds(problem, previous)
        commands, result = self._buffer.inputs["commands"], self._buffer.outputs
        commands[:] = self._guess
        self._buffer.call()
        cost, feasible = result["cost"].item(), self._is_feasible(commands.ravel(), low, high)
        if not cost < math.inf:
            return self._failure(Outcome.NON_FINITE, 0)
        outcome, iterations = Outcome.ITERATION_LIMIT, 0
        while iterations < self._iteration_limit:
            iterations += 1
            current = commands.ravel().copy()
            hessian = result["hessian"]
            linear = result["gradient"][0] - hessian @ current
            target = self._minimise(hessian, linear, high, low, bounds_changed=iterations == 1)
            if target is None:
                # The Hessian is positive definite by construction, so the limits are at fault.
                return self._failure(Outcome.INFEASIBLE, iterations)
            change = target - current
            expected = float(result["gradient"][0] @ change + 0.5 * change @ (hessian @ change))
            if feasible and -expected < self._tolerance * (1.0 + cost):
                outcome = Outcome.CONVERGED
                break
            size, cost = self._search(current, change, cost, feasible)
            feasible = feasible or size == 1.0
            if size == 0.0:
                outcome = Outcome.STALLED
                break
        if not np.isfinite(cost):
            return self._failure(Outcome.NON_FINITE, iterations)
        self._guess[:] = commands
        return Solution(commands.copy(), result["states"].copy(), cost, iterations, outcome)

    def _minimise(
        self, hessian: Array, linear: Array, high: Array, low: Array, *, bounds_changed: bool
    ) -> Array | None:
        """Commands (2N,) that minimise the quadratic model within the limits; None if there are none.

        The QP solver keeps its workspace and starts from the constraints that were active last.
        """
        if self._model is None:
            self._model = daqp.Model()
            self._model.settings = {"primal_tol": FEASIBILITY_TOLERANCE}
            flag = self._model.setup(hessian, linear, self._rows, high, low)[0]
        elif bounds_changed:
            flag = self._model.update(H=hessian, f=linear, bupper=high, blower=low)
        else:
            flag = self._model.update(H=hessian, f=linear)
        if flag < 0:
            return None
        target, _, flag, _ = self._model.solve()
        # Without this look at the flag a failure would pass for a solution.
        return np.asarray(target) if flag > 0 else None

    def _search(self, current: Array, change: Array, cost: float, feasible: bool) -> tuple[float, float]:
        """Take the largest halved step that lowers the cost; from outside the limits, the full one.

        Returns the share of the step and the cost there; 0 and the old cost if none lowers it.
        """
        commands, result = self._buffer.inputs["commands"], self._buffer.outputs
        size = 1.0
        while size >= SMALLEST_STEP:
            commands[:] = (current + size * change).reshape(-1, 2)
            self._buffer.call()
            new_cost = result["cost"].item()
            if new_cost < cost or not feasible:
                return size, new_cost
            size *= 0.5
        commands[:] = current.reshape(-1, 2)
        self._buffer.call()
        return 0.0, cost

    def _load(self, problem: Problem) -> None:
        table = self._buffer.inputs
        table["start"][0] = problem.start
        table["state_reference"][:] = problem.state_reference
        table["input_reference"][:] = problem.input_reference
        table["parameters"][0] = problem.parameters.as_array()
        table["weights"][0] = problem.weight_array()

    def _bounds(self, problem: Problem, previous: Array) -> tuple[Array, Array]:
        """Upper and lower bounds (6N,): commands, track speeds, changes; the first change counts from ``previous``."""
        low = np.broadcast_to(problem.low, (self.horizon, 2))
        high = np.broadcast_to(problem.high, (self.horizon, 2))
        steps = np.tile(self.limits.steps(problem.parameters.period_s), self.horizon)
        tracks = np.full(2 * self.horizon, self.limits.track_speed_mps)
        upper = np.concatenate([high.ravel(), tracks, steps])
        lower = np.concatenate([low.ravel(), -tracks, -steps])
        first = slice(4 * self.horizon, 4 * self.horizon + 2)
        origin = self.limits.nearest(previous, low[0], high[0])
        upper[first] += origin
        lower[first] += origin
        return upper, lower

    def _is_feasible(self, commands: Array, low: Array, high: Array) -> bool:
        values = np.concatenate([commands, self._rows @ commands])
        return bool(np.all(values <= high + FEASIBILITY_TOLERANCE) and np.all(values >= low - FEASIBILITY_TOLERANCE))

    def _failure(self, outcome: Outcome, iterations: int) -> Solution:
        # The workspace may have been left in any state.
        self._model = None
        return super()._failure(outcome, iterations)
