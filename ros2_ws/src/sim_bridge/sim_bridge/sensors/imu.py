"""Inertial measurement unit that averages over its period, as real ones do."""

import math

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from robust_core.plants.x_structure import STANDARD_GRAVITY_MPS2
from sim_bridge.sensors.mounting import PointMotion
from sim_bridge.sensors.rotations import rotation_from_vector, vector_of_rotation
from tracked_description.robot import Imu
from tracked_types import ImuSample

_GRAVITY = np.array([0.0, 0.0, STANDARD_GRAVITY_MPS2])


class ImuSensor:
    """Mean angular rate and mean specific force over each sampling period, with bias and noise.

    The mean force is the change of velocity over the period, not an instantaneous acceleration sampled at
    its end: over an obstacle the latter aliases contact shocks that the former averages as hardware does.
    Both are exact: the force times the period, turned by the orientation at mid-period, less gravity, is
    the change of velocity of the sensor's own point; the rate times the period is the change of orientation.
    """

    def __init__(self, model: Imu, frame_id: str, random: Generator, start: PointMotion) -> None:
        self._model = model
        self._frame_id = frame_id
        self._random = random
        self._period_s = 1.0 / model.rate_hz
        self._gyro_bias = np.full(3, model.gyro_bias_radps)
        self._gyro_covariance = np.eye(3) * model.gyro_noise_radps**2
        self._acceleration_covariance = np.eye(3) * model.acceleration_noise_mps2**2
        self._previous = start

    @property
    def gyro_bias_radps(self) -> NDArray[np.float64]:
        """The bias that the gyro adds now, (3,) in the sensor's frame; estimators are measured against it."""
        return self._gyro_bias.copy()

    def restart(self, motion: PointMotion) -> None:
        """Begin the next period at ``motion``: the robot was put elsewhere, which is no movement."""
        self._previous = motion

    def update(self, motion: PointMotion, stamp_ns: int) -> ImuSample:
        """Sample at the end of a period at which the sensor moves with ``motion``."""
        before, self._previous = self._previous, motion
        turn = vector_of_rotation(before.rotation.T @ motion.rotation)
        middle = before.rotation @ rotation_from_vector(0.5 * turn)
        velocity_change = motion.velocity_mps - before.velocity_mps
        force = middle.T @ (velocity_change / self._period_s + _GRAVITY)
        walk = self._model.gyro_bias_walk_radps_sqrt_s * math.sqrt(self._period_s)
        self._gyro_bias = self._gyro_bias + walk * self._random.standard_normal(3)
        return ImuSample(
            stamp_ns=stamp_ns,
            frame_id=self._frame_id,
            angular_velocity_radps=turn / self._period_s
            + self._gyro_bias
            + self._model.gyro_noise_radps * self._random.standard_normal(3),
            linear_acceleration_mps2=force
            + self._model.acceleration_bias_mps2
            + self._model.acceleration_noise_mps2 * self._random.standard_normal(3),
            angular_velocity_covariance=self._gyro_covariance,
            linear_acceleration_covariance=self._acceleration_covariance,
        )
