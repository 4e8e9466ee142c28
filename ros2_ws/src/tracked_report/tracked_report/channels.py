"""The channels a drive records: one table of names, columns and meaning, and how typed values become rows."""

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np

from tracked_types import BodyState, GoalReached, Odometry, Slip, SolverStatus, TrackSample, Trajectory, VelocityCommand

Row = tuple[int, tuple[float, ...]]
"""Stamp (ns) and one number per column."""

_STATE = ("x_m", "y_m", "yaw_rad", "speed_mps", "yaw_rate_radps")
_COMMAND = ("speed_mps", "yaw_rate_radps")
_STATUS = ("ok", "iterations", "cost", "cpu_time_s")
_SLIP = ("speed_mps", "yaw_rate_radps", "speed_variance", "yaw_rate_variance", "known")


@dataclass(frozen=True, slots=True)
class ChannelKind:
    """One row of the table. ``rows`` turns a typed value into rows; ``newest_wins``: a value replaces what an
    earlier one said of the same and later instants (plans that are issued again and again)."""

    columns: tuple[str, ...]
    description: str
    rows: Callable[[Any], Iterable[Row]]
    newest_wins: bool = False


def _truth(state: BodyState) -> Iterable[Row]:
    speed, lateral, _ = state.velocity_mps.tolist()
    turning = float(state.angular_velocity_radps[2])
    pose = (*state.position_m.tolist(), *state.roll_pitch_yaw_rad.tolist())
    yield state.stamp_ns, (*pose, speed, lateral, turning)


def _acceleration(state: BodyState) -> Iterable[Row]:
    yield state.stamp_ns, (state.vertical_acceleration_mps2,)


def _odometry(odometry: Odometry) -> Iterable[Row]:
    pose, twist, variances = odometry.pose, odometry.twist, odometry.pose_covariance.diagonal().tolist()
    yield odometry.stamp_ns, (pose.x_m, pose.y_m, pose.yaw_rad, twist.speed_mps, twist.yaw_rate_radps, *variances)


def _slip(slip: Slip) -> Iterable[Row]:
    known = float(slip.known)
    yield slip.stamp_ns, (slip.speed_mps, slip.yaw_rate_radps, slip.speed_variance, slip.yaw_rate_variance, known)


def _tracks(sample: TrackSample) -> Iterable[Row]:
    speeds = (math.nan if speed is None else speed for speed in (sample.left_speed_mps, sample.right_speed_mps))
    yield sample.stamp_ns, (sample.left_travel_m, sample.right_travel_m, *speeds)


def _points(trajectory: Trajectory) -> Iterable[Row]:
    rows = np.column_stack([trajectory.states, trajectory.inputs]).tolist()
    for time_s, row in zip(trajectory.times_s.tolist(), rows, strict=True):
        yield trajectory.stamp_ns + round(time_s * 1e9), tuple(row)


def _first_point(trajectory: Trajectory) -> Iterable[Row]:
    yield trajectory.start_ns, (*trajectory.states[0].tolist(), *trajectory.inputs[0].tolist())


def _command(command: VelocityCommand) -> Iterable[Row]:
    yield command.stamp_ns, (command.twist.speed_mps, command.twist.yaw_rate_radps)


def _status(status: SolverStatus) -> Iterable[Row]:
    yield status.stamp_ns, (float(status.ok), float(status.iterations), status.cost, status.cpu_time_s)


def _goal(goal: GoalReached) -> Iterable[Row]:
    yield goal.stamp_ns, (goal.position_error_m, goal.yaw_error_rad)


_TRUTH = ("x_m", "y_m", "z_m", "roll_rad", "pitch_rad", "yaw_rad", "speed_mps", "lateral_speed_mps", "yaw_rate_radps")
_VARIANCES = ("x_variance", "y_variance", "yaw_variance")
_TRACK_COLUMNS = ("left_travel_m", "right_travel_m", "left_speed_mps", "right_speed_mps")

CHANNELS: dict[str, ChannelKind] = {
    "truth": ChannelKind(_TRUTH, "pose of base_footprint in the world, velocity in its own frame", _truth),
    "truth_slip": ChannelKind(_SLIP, "true ground motion minus belt motion", _slip),
    "acceleration": ChannelKind(("vertical_mps2",), "true, along world z, gravity removed", _acceleration),
    "odometry": ChannelKind((*_STATE, *_VARIANCES), "estimated pose in the odom frame, twist, variances", _odometry),
    "slip": ChannelKind(_SLIP, "estimated ground motion minus belt motion", _slip),
    "tracks": ChannelKind(_TRACK_COLUMNS, "belt encoders", _tracks),
    "reference": ChannelKind(_STATE, "reference in the odom frame, all points", _points, newest_wins=True),
    "upper_plan": ChannelKind(_STATE, "first state and input of each upper plan, in the odom frame", _first_point),
    "cmd_vel_nav": ChannelKind(_COMMAND, "commands of the control layers", _command),
    "cmd_vel": ChannelKind(_COMMAND, "commands sent to the base; stamp: the odometry they answer", _command),
    "upper_status": ChannelKind(_STATUS, "one tick of the upper layer", _status),
    "lower_status": ChannelKind(_STATUS, "one tick of the lower layer", _status),
    "goal_reached": ChannelKind(("position_error_m", "yaw_error_rad"), "arrival at the end of a reference", _goal),
}
