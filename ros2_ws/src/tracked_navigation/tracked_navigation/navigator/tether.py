"""Where the next band begins: on the last one, but never far from the robot."""

import math

import numpy as np

from tracked_navigation.motion_limits import MotionLimits
from tracked_types import Pose2, Trajectory, Twist2, wrap_angle

_LAG_S = 0.3  # a robot on its way to a reference's velocity needs about this long


def tethered(
    last: Trajectory | None,
    pose: Pose2,
    twist: Twist2,
    stamp_ns: int,
    limits: MotionLimits,
    *,
    length_m: float,
    turn_rad: float,
) -> tuple[Pose2, Twist2]:
    """State at ``stamp_ns`` that the next band begins with.

    ``last`` is the trajectory that is being driven, in the frame of ``pose``. Beginning on it keeps the reference free
    of jumps and leaves the error to the controllers; pulling the begin to within ``length_m`` and ``turn_rad`` of the
    robot keeps what was checked true of the robot.
    """
    if last is None:
        return pose, twist
    states, inputs = last.at(stamp_ns, np.zeros(1))
    x, y, yaw = states[0].tolist()
    off_x, off_y = x - pose.x_m, y - pose.y_m
    distance = math.hypot(off_x, off_y)
    kept = min(1.0, length_m / distance) if distance > 0.0 else 1.0
    turn = min(max(wrap_angle(yaw - pose.yaw_rad), -turn_rad), turn_rad)
    begin = Pose2(pose.x_m + kept * off_x, pose.y_m + kept * off_y, wrap_angle(pose.yaw_rad + turn))
    speed, yaw_rate = inputs[0].tolist()
    faster, swifter = limits.acceleration_mps2 * _LAG_S, limits.yaw_acceleration_radps2 * _LAG_S
    return begin, Twist2(
        min(max(speed, twist.speed_mps - faster), twist.speed_mps + faster),
        min(max(yaw_rate, twist.yaw_rate_radps - swifter), twist.yaw_rate_radps + swifter),
    )
