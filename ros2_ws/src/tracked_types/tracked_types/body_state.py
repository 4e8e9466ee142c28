"""Full rigid-body state, as a simulator or a motion-capture system knows it."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tracked_types.pose import Pose2
from tracked_types.twist import Twist2


@dataclass(frozen=True, slots=True)
class BodyState:
    """State of base_footprint's body at one instant.

    position_m: (3,) of the base in the world; roll_pitch_yaw_rad: (3,) REP-103 fixed-axis angles.
    velocity_mps, angular_velocity_radps: (3,) in the base frame.
    vertical_acceleration_mps2: world z, gravity removed, mean over the sampling period.
    """

    stamp_ns: int
    position_m: NDArray[np.float64]
    roll_pitch_yaw_rad: NDArray[np.float64]
    velocity_mps: NDArray[np.float64]
    angular_velocity_radps: NDArray[np.float64]
    vertical_acceleration_mps2: float

    @property
    def pose(self) -> Pose2:
        """Planar pose of the base in the world."""
        return Pose2(float(self.position_m[0]), float(self.position_m[1]), float(self.roll_pitch_yaw_rad[2]))

    @property
    def twist(self) -> Twist2:
        """Forward speed and yaw rate of the base."""
        return Twist2(float(self.velocity_mps[0]), float(self.angular_velocity_radps[2]))
