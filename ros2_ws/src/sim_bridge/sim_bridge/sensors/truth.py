"""Ground truth: what an ideal outside observer would report."""

from dataclasses import dataclass

import numpy as np

from sim_bridge.sensors.mounting import PointMotion
from sim_bridge.sensors.rotations import (
    roll_pitch_yaw_of,
    rotation_from_vector,
    vector_of_rotation,
)
from tracked_types import BodyState, Slip


@dataclass(frozen=True, slots=True)
class BaseMotion:
    """Motion of base_footprint and the unquantised travel (m) of both belts at one instant."""

    base: PointMotion
    left_travel_m: float
    right_travel_m: float


class TruthObserver:
    """Body state at each sampling instant, and the slip over the period that ends there.

    Slip is the mean ground motion less the mean belt motion over the encoders' own period, so that it can
    be compared with an estimate made from encoder differences sample by sample. Mean ground speed is the
    displacement along the body's x axis at mid-period; yaw rates are about the body's z axis.
    """

    def __init__(self, gauge_m: float, rate_hz: int, start: BaseMotion) -> None:
        self._gauge_m = gauge_m
        self._period_s = 1.0 / rate_hz
        self._previous = start

    def restart(self, motion: BaseMotion) -> None:
        """Begin the next period at ``motion``: the robot was put elsewhere, which is no movement."""
        self._previous = motion

    def update(self, motion: BaseMotion, stamp_ns: int) -> tuple[BodyState, Slip]:
        """Truth at the end of a period at which the base moves with ``motion``."""
        before, self._previous = self._previous, motion
        return self._body_state(before.base, motion.base, stamp_ns), self._slip(before, motion, stamp_ns)

    def _body_state(self, before: PointMotion, now: PointMotion, stamp_ns: int) -> BodyState:
        return BodyState(
            stamp_ns=stamp_ns,
            position_m=now.position_m,
            roll_pitch_yaw_rad=roll_pitch_yaw_of(now.rotation),
            velocity_mps=now.rotation.T @ now.velocity_mps,
            angular_velocity_radps=now.rotation.T @ now.angular_velocity_radps,
            vertical_acceleration_mps2=float(now.velocity_mps[2] - before.velocity_mps[2]) / self._period_s,
        )

    def _slip(self, before: BaseMotion, now: BaseMotion, stamp_ns: int) -> Slip:
        turn = vector_of_rotation(before.base.rotation.T @ now.base.rotation)
        forward = (before.base.rotation @ rotation_from_vector(0.5 * turn))[:, 0]
        ground_travel = float(np.dot(now.base.position_m - before.base.position_m, forward))
        left = now.left_travel_m - before.left_travel_m
        right = now.right_travel_m - before.right_travel_m
        return Slip(
            stamp_ns=stamp_ns,
            speed_mps=(ground_travel - 0.5 * (left + right)) / self._period_s,
            yaw_rate_radps=(float(turn[2]) - (right - left) / self._gauge_m) / self._period_s,
            speed_variance=0.0,
            yaw_rate_variance=0.0,
            known=True,
        )
