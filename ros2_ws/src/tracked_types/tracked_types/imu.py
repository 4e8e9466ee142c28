"""Inertial measurement."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, slots=True)
class ImuSample:
    """One IMU sample in the IMU's frame (REP-145).

    angular_velocity_radps, linear_acceleration_mps2: shape (3,); the acceleration is proper, so a level
    sensor at rest reads +9.81 on z. The covariances are 3x3, (rad/s)^2 and (m/s^2)^2.
    """

    stamp_ns: int
    frame_id: str
    angular_velocity_radps: NDArray[np.float64]
    linear_acceleration_mps2: NDArray[np.float64]
    angular_velocity_covariance: NDArray[np.float64]
    linear_acceleration_covariance: NDArray[np.float64]
