"""One optimal control problem, (5.2.6) or (5.2.13)."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from nmpc_layers.solver.motion_model import MotionParameters
from nmpc_layers.solver.terminal_weight import TerminalWeight
from nmpc_layers.solver.weights import STAGE_COUNT, Weights

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Problem:
    """Data of one problem over N stages; headings are continuous, not wrapped.

    start: (n,) initial state, see `Motion`. state_reference: (N + 1, 3) x, y, yaw.
    input_reference: (N, 2) speed and yaw rate of the belts. low, high: (N, 2) bounds of each stage's
    command, or (2,) for all stages alike. terminal: weight of the last pose error instead of the diagonal one
    that ``weights`` give it; it turns with the last heading of the reference.
    """

    start: Array
    state_reference: Array
    input_reference: Array
    low: Array
    high: Array
    parameters: MotionParameters
    weights: Weights
    terminal: TerminalWeight | None = None

    def is_finite(self) -> bool:
        """Whether every number is finite."""
        tables = (self.start, self.state_reference, self.input_reference, self.low, self.high)
        return all(bool(np.isfinite(table).all()) for table in tables)

    def weight_array(self) -> Array:
        """Weights as the solvers take them, the last pose's in world axes; as `Weights.as_array`, shape (11,)."""
        array = self.weights.as_array()
        if self.terminal is not None:
            array[STAGE_COUNT:] = self.terminal.in_world(float(self.state_reference[-1, 2]))
        return array
