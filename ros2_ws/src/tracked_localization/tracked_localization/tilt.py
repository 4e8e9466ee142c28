"""Roll and pitch of the base from gyro and gravity."""

import math

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from tracked_types import ImuSample, seconds_between

_GRAVITY_MPS2 = 9.80665
_TRUST_S = 1.5  # time constant with which gravity corrects what the gyro says
_QUIET_SHARE = 0.15  # an acceleration this far off gravity says little about which way is up
_LONGEST_GAP_S = 0.2
_MOST_RAD = 1.2


class Tilt:
    """Complementary filter on the IMU's samples, in the order of their stamps.

    roll_rad, pitch_rad: fixed-axis angles of the base (REP-103); both 0 before the first sample.
    """

    def __init__(self, imu_roll_pitch_yaw_rad: tuple[float, float, float]) -> None:
        self._base_from_imu = Rotation.from_euler("xyz", imu_roll_pitch_yaw_rad).as_matrix()
        self._stamp_ns: int | None = None
        self.roll_rad, self.pitch_rad = 0.0, 0.0

    def add(self, sample: ImuSample) -> None:
        """Take in a sample; one that is not finite or not newer than the last says nothing."""
        rate = self._base_from_imu @ sample.angular_velocity_radps
        force = self._base_from_imu @ sample.linear_acceleration_mps2
        if not (np.isfinite(rate).all() and np.isfinite(force).all()):
            return
        measured = _up_of(force)
        period_s = math.inf if self._stamp_ns is None else seconds_between(sample.stamp_ns, self._stamp_ns)
        if period_s <= 0.0 and period_s > -_LONGEST_GAP_S:
            return
        self._stamp_ns = sample.stamp_ns
        if not 0.0 < period_s <= _LONGEST_GAP_S:
            self.roll_rad, self.pitch_rad = measured
            return
        roll, pitch = self.roll_rad, self.pitch_rad
        turning = rate[1] * math.sin(roll) + rate[2] * math.cos(roll)
        roll += period_s * (rate[0] + math.tan(pitch) * turning)
        pitch += period_s * (rate[1] * math.cos(roll) - rate[2] * math.sin(roll))
        loudness = abs(float(np.linalg.norm(force)) / _GRAVITY_MPS2 - 1.0) / _QUIET_SHARE
        share = max(0.0, 1.0 - loudness) * period_s / _TRUST_S
        self.roll_rad = _limited(roll + share * (measured[0] - roll))
        self.pitch_rad = _limited(pitch + share * (measured[1] - pitch))


def _up_of(force: NDArray[np.float64]) -> tuple[float, float]:
    x, y, z = force.tolist()
    return _limited(math.atan2(y, z)), _limited(math.atan2(-x, math.hypot(y, z)))


def _limited(angle_rad: float) -> float:
    """A robot beyond this has other worries, and the tangent of its pitch must stay finite."""
    return min(max(angle_rad, -_MOST_RAD), _MOST_RAD)
