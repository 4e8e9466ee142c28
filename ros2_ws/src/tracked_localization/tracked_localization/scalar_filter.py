"""filterpy's extended Kalman filter for measurements that are a single number."""

import math
from typing import Any

from filterpy.kalman import ExtendedKalmanFilter

from tracked_localization.state import Array


class ScalarFilter(ExtendedKalmanFilter):  # type: ignore[misc]
    """Same prediction; the correction needs no inverse and no product of matrices, which took most time.

    The covariance loses the outer product of one vector with itself, so it stays exactly symmetric. After
    `update_scalar` the attribute ``K`` holds the gain (n, 1), as after filterpy's ``update``.
    """

    x: Any
    P: Any
    K: Any

    def __init__(self, size: int) -> None:
        super().__init__(dim_x=size, dim_z=1)

    def update_scalar(self, value: float, measured: Array, variance: float) -> None:
        """Correct by a ``value`` that measures the row ``measured`` (1, n) of the state with this variance."""
        row = measured[0]
        spread = self.P @ row
        innovation_variance = float(row @ spread) + variance
        gain = spread / innovation_variance
        self.x += gain * (value - float(row @ self.x))
        lost = spread / math.sqrt(innovation_variance)
        self.P -= lost[:, None] * lost
        self.K = gain[:, None]
