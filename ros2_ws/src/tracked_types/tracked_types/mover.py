"""Something that moves by itself: a person, another robot."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

_ANGLES = np.linspace(0.0, 2.0 * np.pi, 24, endpoint=False)
_CIRCLE = np.column_stack([np.cos(_ANGLES), np.sin(_ANGLES)])


@dataclass(frozen=True, slots=True)
class Mover:
    """A disc that goes on as it goes.

    identity: the same number as long as it is followed. frame_id: of position (m) and velocity (m/s), each (2,).
    covariance: of x, y and their rates, (4, 4). radius_m: of the disc that holds what was seen of it.
    """

    identity: int
    stamp_ns: int
    frame_id: str
    position_m: NDArray[np.float64]
    velocity_mps: NDArray[np.float64]
    covariance: NDArray[np.float64]
    radius_m: float

    def position_at(self, after_s: float) -> NDArray[np.float64]:
        """Where it is ``after_s`` seconds after its stamp if it goes on, (2,)."""
        ahead: NDArray[np.float64] = self.position_m + after_s * self.velocity_mps
        return ahead

    @property
    def rim(self) -> NDArray[np.float64]:
        """Points (24, 2) on the edge of its disc at its stamp."""
        edge: NDArray[np.float64] = self.position_m + self.radius_m * _CIRCLE
        return edge
