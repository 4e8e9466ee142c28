"""How far the robot is from where its reference wants it."""

import numpy as np
from numpy.typing import NDArray

from tracked_types import Odometry, Trajectory, angle_difference


def tracking_error(odometry: Odometry, reference: Trajectory) -> NDArray[np.float64]:
    """Estimated pose minus ``reference`` at the odometry's stamp: x (m), y (m), heading (rad, wrapped), (3,)."""
    states, _ = reference.at(odometry.stamp_ns, np.zeros(1))
    error: NDArray[np.float64] = odometry.pose.as_array() - states[0]
    error[2] = angle_difference(odometry.pose.yaw_rad, float(states[0, 2]))
    return error
