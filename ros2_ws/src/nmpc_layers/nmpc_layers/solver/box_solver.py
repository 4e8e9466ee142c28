"""Solver of the problem with box limits on the commands."""

import math
from pathlib import Path
from typing import Any

from casadi_code import FunctionBuffer, cache_directory, compiled
from nmpc_layers.solver.motion_model import Motion
from nmpc_layers.solver.problem import Problem
from nmpc_layers.solver.riccati import riccati_iteration
from nmpc_layers.solver.solution import Outcome, Solution
from nmpc_layers.solver.warm_start import WarmStart

_MACHINE_CODE: dict[tuple[Motion, int, Path], Any] = {}
"""Iterations that this process has loaded: building one to look it up in the cache takes longer than most solves."""


class BoxSolver(WarmStart):
    """Control-limited Gauss-Newton method for one structure of model and one horizon.

    Parameters
    ----------
    motion, horizon: structure of the problem; all its numbers are run-time inputs.
    iteration_limit: iterations after which a solve gives up.
    tolerance: fall of the cost, relative to 1 + cost, below which the model of an iteration makes it the last.
    use_compiler: False runs the CasADi interpreter.
    """

    def __init__(
        self,
        motion: Motion,
        horizon: int,
        *,
        iteration_limit: int = 40,
        tolerance: float = 1e-9,
        use_compiler: bool = True,
    ) -> None:
        super().__init__(motion, horizon)
        function, self.interpreter_reason = _iteration(motion, horizon, use_compiler)
        self._iteration_limit, self._tolerance = iteration_limit, tolerance
        self._buffer = FunctionBuffer(function)

    @property
    def is_compiled(self) -> bool:
        """Whether machine code runs; if not, `interpreter_reason` says why."""
        return not self.interpreter_reason

    def solve(self, problem: Problem) -> Solution:
        """Solve from the current guess, which the solution then replaces (see `shift`).

        Never raises for bad numbers: the outcome tells. After anything but convergence the guess is forgotten.
        """
        table, result = self._buffer.inputs, self._buffer.outputs
        table["start"][0] = problem.start
        table["state_reference"][:] = problem.state_reference
        table["input_reference"][:] = problem.input_reference
        table["parameters"][0] = problem.parameters.as_array()
        table["weights"][0] = problem.weight_array()
        table["bounds"][:, :2] = problem.low
        table["bounds"][:, 2:] = problem.high
        commands, new_commands = table["commands"], result["new_commands"]
        commands[:] = self._guess
        outcome, iterations = Outcome.ITERATION_LIMIT, 0
        while iterations < self._iteration_limit:
            self._buffer.call()
            iterations += 1
            commands[:] = new_commands
            cost, change, expected = result["new_cost"].item(), result["change"].item(), result["expected"].item()
            # A number that is not finite anywhere in the problem makes the cost so (and fails every comparison).
            if not cost < math.inf:
                return self._failure(Outcome.NON_FINITE, iterations)
            if -expected < self._tolerance * (1.0 + cost):
                outcome = Outcome.CONVERGED
                break
            if change == 0.0:
                outcome = Outcome.STALLED
                break
        self._guess[:] = commands
        return Solution(commands.copy(), result["states"].copy(), cost, iterations, outcome)


def _iteration(motion: Motion, horizon: int, use_compiler: bool) -> tuple[Any, str]:
    """The function of one iteration, and the reason why it is not machine code ("" if it is)."""
    if not use_compiler:
        return riccati_iteration(motion, horizon), "not asked to compile"
    key = (motion, horizon, cache_directory())
    if key in _MACHINE_CODE:
        return _MACHINE_CODE[key], ""
    function, reason = compiled(riccati_iteration(motion, horizon))
    if not reason:
        _MACHINE_CODE[key] = function
    return function, reason
