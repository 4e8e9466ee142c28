"""Weights of the quadratic cost (5.2.4), (5.2.12)."""

import math
from dataclasses import dataclass, fields
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from nmpc_layers.solver.terminal_weight import PACKED_COUNT

STAGE_COUNT = 5
WEIGHT_COUNT = STAGE_COUNT + PACKED_COUNT


@dataclass(frozen=True, slots=True, kw_only=True)
class Weights:
    """Diagonals of Q1, Q2, Q3 (upper layer) or P1, P2, P3 (lower layer).

    position (1/m^2) and heading (1/rad^2) weigh the pose error of every stage, speed ((s/m)^2) and
    yaw_rate ((s/rad)^2) the input error; the last stage weighs pose errors ``terminal`` times as much.

    Raises
    ------
    ValueError: if a weight is not finite, an input or terminal weight is not positive, or a pose weight negative.
    """

    # Read by pydantic where weights come from a file: unknown keys are errors there.
    __pydantic_config__: ClassVar[dict[str, str]] = {"extra": "forbid"}

    position: float
    heading: float
    speed: float
    yaw_rate: float
    terminal: float

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            floor_allowed = field.name in ("position", "heading")
            if not math.isfinite(value) or value < 0.0 or (value == 0.0 and not floor_allowed):
                bound = "at least 0" if floor_allowed else "above 0"
                raise ValueError(f"weight {field.name} must be finite and {bound}, got {value!r}")

    def as_array(self) -> NDArray[np.float64]:
        """Diagonals of pose and inputs, then the upper triangle of the last pose's weight; shape (11,)."""
        place, heading = self.position, self.heading
        last_place, last_heading = self.terminal * place, self.terminal * heading
        last = (last_place, 0.0, 0.0, last_place, 0.0, last_heading)
        return np.array([place, place, heading, self.speed, self.yaw_rate, *last])
