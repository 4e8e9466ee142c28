"""Pieces of reference: carried into another frame, braking, standing."""

import numpy as np

from tracked_navigation.band.braking import stops
from tracked_navigation.band.rollout import as_trajectory
from tracked_navigation.motion_limits import MotionLimits
from tracked_types import Odometry, Pose2, Trajectory, Twist2, seconds_between, wrap_angle

_PLAUSIBLE = 3.0  # times its limits


def in_frame(trajectory: Trajectory, frame_id: str, pose: Pose2, *, from_ns: int | None = None) -> Trajectory:
    """The same way in the frame in which the trajectory's own is at ``pose``; stamped ``from_ns`` and without what was
    before, if that is given and lies before its end."""
    states = np.column_stack([pose.transform(trajectory.states[:, :2]), trajectory.states[:, 2] + pose.yaw_rad])
    states[:, 2] = wrap_angle(states[:, 2])
    moved = Trajectory(trajectory.stamp_ns, frame_id, trajectory.times_s, states, trajectory.inputs)
    if from_ns is None or not moved.start_ns < from_ns < moved.end_ns:
        return moved
    begin_s = seconds_between(from_ns, moved.stamp_ns)
    later = moved.times_s > begin_s + 1e-6
    first_state, first_input = moved.at(from_ns, np.zeros(1))
    return Trajectory(
        from_ns,
        frame_id,
        np.concatenate([[0.0], moved.times_s[later] - begin_s]),
        np.concatenate([first_state, moved.states[later]]),
        np.concatenate([first_input, moved.inputs[later]]),
    )


def braked(odometry: Odometry, limits: MotionLimits) -> Trajectory:
    """To rest from where the robot is, along the arc that it is on; at once if its velocity makes no sense."""
    twist = odometry.twist
    fastest, swiftest = _PLAUSIBLE * limits.speed_max_mps, _PLAUSIBLE * limits.yaw_rate_radps
    if not (abs(twist.speed_mps) <= fastest and abs(twist.yaw_rate_radps) <= swiftest):
        twist = Twist2(0.0, 0.0)
    _, along_the_arc = stops(odometry.pose, twist, limits)
    return as_trajectory(odometry.stamp_ns, odometry.frame_id, *along_the_arc)


def standing(pose: Pose2, stamp_ns: int, frame_id: str) -> Trajectory:
    """At rest at ``pose``."""
    return Trajectory(stamp_ns, frame_id, np.zeros(1), pose.as_array()[None, :], np.zeros((1, 2)))
