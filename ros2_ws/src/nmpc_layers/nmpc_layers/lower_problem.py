"""The lower layer's optimal control problem, as printed and improved."""

import numpy as np
from numpy.typing import NDArray

from nmpc_layers.lower_settings import LowerSettings
from nmpc_layers.plan_shapes import continuous_headings, step_times
from nmpc_layers.sent_commands import GroundModel, SentCommands, predict
from nmpc_layers.solver import Motion, MotionParameters, Problem
from tracked_types import Odometry, Slip, Trajectory, Twist2, to_nanoseconds

Array = NDArray[np.float64]


class PrintedProblem:
    """(5.2.12)-(5.2.13): kinematic model from the measured pose, slip added, inputs drawn to the plan's.

    Of the errata only those without which it does not work: increments are added to the state (erratum
    5.2.6) and the plan is interpolated in time (erratum 5.2.12).
    """

    motion = Motion.KINEMATIC

    def __init__(self, settings: LowerSettings) -> None:
        self._settings = settings
        self._offsets = step_times(settings.period_s, settings.horizon)
        self.horizon_start_s = 0.0

    def build(self, odometry: Odometry, plan: Trajectory, slip: Slip | None, sent: SentCommands) -> Problem:
        """The problem of one tick; ``slip`` None compensates nothing."""
        settings = self._settings
        states, inputs = plan.at(odometry.stamp_ns, self._offsets)
        parameters = MotionParameters(
            period_s=settings.period_s,
            heading_point=0.0,
            speed_slip_mps=slip.speed_mps if slip else 0.0,
            yaw_slip_radps=slip.yaw_rate_radps if slip else 0.0,
        )
        return Problem(
            start=odometry.pose.as_array(),
            state_reference=continuous_headings(states, odometry.pose.yaw_rad),
            input_reference=inputs[:-1],
            low=settings.limits.low,
            high=settings.limits.high,
            parameters=parameters,
            weights=settings.weights,
        )


class ImprovedProblem:
    """Belts that lag, a horizon that starts where this tick's command reaches the motors, consistent targets.

    The state is predicted there with the commands already on their way. The slip that `yaw_ratio` does not explain is
    added, and the sideways slide is in the model. Targets are the plan's ground motion less the slip, so that input
    weights do not work against the compensation (erratum 5.2.12).
    """

    motion = Motion.LAG

    def __init__(self, settings: LowerSettings) -> None:
        self._settings = settings
        self._offsets = step_times(settings.period_s, settings.horizon)
        self.horizon_start_s = settings.transport_delay_s

    def build(self, odometry: Odometry, plan: Trajectory, slip: Slip | None, sent: SentCommands) -> Problem:
        """The problem of one tick; ``slip`` None compensates nothing."""
        settings = self._settings
        start_ns = odometry.stamp_ns + to_nanoseconds(self.horizon_start_s)
        ground, belts = self._ground(odometry, slip)
        pose, belts = predict(
            odometry.pose, belts, sent.in_force(odometry.stamp_ns, start_ns, before_ns=odometry.stamp_ns), ground
        )
        states, _ = plan.at(start_ns, self._offsets)
        _, inputs = plan.at(start_ns, self._offsets[:-1] + 0.5 * settings.period_s)
        low, high = settings.limits.low, settings.limits.high
        slipped = np.array([ground.speed_slip_mps, ground.yaw_slip_radps])
        targets = (inputs - slipped) / np.array([1.0, ground.yaw_efficiency])
        return Problem(
            start=np.array([*pose.as_array(), belts.speed_mps, belts.yaw_rate_radps]),
            state_reference=continuous_headings(states, pose.yaw_rad),
            input_reference=np.clip(targets, low, high),
            low=low,
            high=high,
            parameters=MotionParameters(
                period_s=settings.period_s,
                speed_slip_mps=ground.speed_slip_mps,
                yaw_slip_radps=ground.yaw_slip_radps,
                yaw_efficiency=ground.yaw_efficiency,
                lag_s=settings.motor_lag_s,
                slide_s=ground.slide_s,
            ),
            weights=settings.weights,
        )

    def _ground(self, odometry: Odometry, slip: Slip | None) -> tuple[GroundModel, Twist2]:
        """What the ground makes of belt motion, and the belts' twist now.

        Odometry tells the ground's yaw rate, and the belts' speed unless measured poses show that of the ground.
        """
        settings, twist = self._settings, odometry.twist
        if slip is None:
            return GroundModel(lag_s=settings.motor_lag_s), twist
        efficiency = settings.yaw_ratio
        if not slip.known:
            ground = GroundModel(yaw_efficiency=efficiency, lag_s=settings.motor_lag_s, slide_s=slip.slide_s)
            return ground, Twist2(twist.speed_mps, twist.yaw_rate_radps / efficiency)
        belt_yaw_rate = twist.yaw_rate_radps - slip.yaw_rate_radps
        belt_speed = twist.speed_mps - (slip.speed_mps if slip.speed_measured else 0.0)
        ground = GroundModel(
            speed_slip_mps=slip.speed_mps if settings.speed_slip or slip.speed_measured else 0.0,
            yaw_slip_radps=slip.yaw_rate_radps + (1.0 - efficiency) * belt_yaw_rate,
            yaw_efficiency=efficiency,
            lag_s=settings.motor_lag_s,
            slide_s=slip.slide_s,
        )
        return ground, Twist2(belt_speed, belt_yaw_rate)


def make_problem(settings: LowerSettings) -> PrintedProblem | ImprovedProblem:
    """The problem of the method that the settings name."""
    return ImprovedProblem(settings) if settings.method == "improved" else PrintedProblem(settings)
