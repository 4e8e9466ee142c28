"""filterpy's extended Kalman filter for measurements that are a single number."""

from typing import Any

import numpy as np
from filterpy.kalman import ExtendedKalmanFilter

from tracked_localization.state import Array


class ScalarFilter(ExtendedKalmanFilter):  # type: ignore[misc]
    """Same prediction and same (Joseph) correction, without inverting matrices of one element, which took most time.

    After `update_scalar` the attribute ``K`` holds the gain (n, 1), as after filterpy's ``update``.
    """

    x: Any
    P: Any
    K: Any

    def __init__(self, size: int) -> None:
        super().__init__(dim_x=size, dim_z=1)
        self._identity = np.eye(size)

    def update_scalar(self, value: float, measured: Array, variance: float) -> None:
        """Correct by a ``value`` that measures the row ``measured`` (1, n) of the state with this variance."""
        row = measured[0]
        spread = self.P @ row
        gain = spread / (float(row @ spread) + variance)
        self.x = self.x + gain * (value - float(row @ self.x))
        keep = self._identity - gain[:, None] * row
        self.P = keep @ self.P @ keep.T + variance * (gain[:, None] * gain)
        self.K = gain[:, None]
