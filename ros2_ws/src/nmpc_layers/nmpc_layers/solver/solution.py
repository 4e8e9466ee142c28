"""What a solver returns."""

from dataclasses import dataclass
from enum import Enum

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class Outcome(Enum):
    """How a solve ended; only CONVERGED commands are to be driven."""

    CONVERGED = "converged"
    ITERATION_LIMIT = "iteration limit reached before convergence"
    STALLED = "no step lowers the cost although the model expects one"
    NON_FINITE = "non-finite numbers in the problem or its solution"
    INFEASIBLE = "no command sequence keeps the limits"


@dataclass(frozen=True, slots=True)
class Solution:
    """Commands (N, 2), states (N + 1, n) they lead to, cost, iterations and outcome of one solve.

    The arrays are the caller's own.
    """

    commands: Array
    states: Array
    cost: float
    iterations: int
    outcome: Outcome

    @property
    def converged(self) -> bool:
        """Whether the commands are a solution."""
        return self.outcome is Outcome.CONVERGED
