"""What every own solver does with its guess."""

import numpy as np
from numpy.typing import NDArray

from nmpc_layers.solver.motion_model import Motion
from nmpc_layers.solver.solution import Outcome, Solution

Array = NDArray[np.float64]


class WarmStart:
    """Keeps the commands from which the next solve starts.

    Parameters
    ----------
    motion, horizon: structure of the problem.

    Raises
    ------
    ValueError: if the horizon has less than two stages.
    """

    def __init__(self, motion: Motion, horizon: int) -> None:
        if horizon < 2:
            raise ValueError(f"horizon must be at least 2, got {horizon}")
        self.motion, self.horizon = motion, horizon
        self._guess = np.zeros((horizon, 2))

    @property
    def guess(self) -> Array:
        """Commands (N, 2) from which the next solve starts; a copy."""
        return self._guess.copy()

    def start_from(self, guess: Array) -> None:
        """Set the commands (N, 2) from which the next solve starts; limits need not be kept."""
        self._guess[:] = guess

    def shift(self, stages: int) -> None:
        """Move the guess ``stages`` stages ahead, repeating its last command."""
        stages = min(max(stages, 0), self.horizon - 1)
        if stages:
            self._guess[:-stages] = self._guess[stages:].copy()
            self._guess[-stages:] = self._guess[-1]

    def _failure(self, outcome: Outcome, iterations: int) -> Solution:
        """A solution without one; the guess is forgotten, since it may be what led here."""
        self._guess[:] = 0.0
        states = np.full((self.horizon + 1, self.motion.state_count), np.nan)
        return Solution(np.zeros((self.horizon, 2)), states, float("nan"), iterations, outcome)
