"""Short way from rest at one pose to rest at another: turns on the spot and straight drives."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tracked_types import Pose2, Trajectory, wrap_angle

Array = NDArray[np.float64]

SAMPLE_STEP_S = 0.05
PAUSE_S = 0.3  # between legs: lets the belts' lag run out before the motion changes its kind
ALIGNED_M = 0.003  # sideways offsets below this are not worth a turn
REACH_M = 0.15  # a sideways offset below this is made good by a slanted drive of this length
DIRECT_M = 0.4  # from farther away the robot drives straight at the goal


@dataclass(frozen=True, slots=True)
class ManoeuvreRates:
    """Largest speed (m/s), yaw rate (rad/s), acceleration (m/s^2) and yaw acceleration (rad/s^2)."""

    speed_mps: float
    yaw_rate_radps: float
    acceleration_mps2: float
    yaw_acceleration_radps2: float


@dataclass(frozen=True, slots=True)
class _Leg:
    turn_rad: float = 0.0
    drive_m: float = 0.0


def manoeuvre(start: Pose2, goal: Pose2, rates: ManoeuvreRates, stamp_ns: int, frame_id: str) -> Trajectory:
    """Trajectory from ``start`` to ``goal``, both at rest, beginning at ``stamp_ns``.

    The robot cannot move sideways, and a controller of the form (5.2.4) with a resting target does not find
    a way round (erratum 5.2.20). A small sideways offset becomes a slanted drive backwards or forwards and
    a straight drive back; turns stay small.
    """
    offset = goal.inverse().compose(start)
    poses, inputs = [np.array([[offset.x_m, offset.y_m, offset.yaw_rad]])], [np.zeros((1, 2))]
    for leg in _legs(offset):
        leg_poses, leg_inputs = _sample(leg, poses[-1][-1], rates)
        poses.append(leg_poses)
        inputs.append(leg_inputs)
    states, commands = np.concatenate(poses), np.concatenate(inputs)
    cosine, sine = math.cos(goal.yaw_rad), math.sin(goal.yaw_rad)
    placed = np.column_stack(
        [
            goal.x_m + cosine * states[:, 0] - sine * states[:, 1],
            goal.y_m + sine * states[:, 0] + cosine * states[:, 1],
            wrap_angle(goal.yaw_rad + states[:, 2]),
        ]
    )
    times = SAMPLE_STEP_S * np.arange(len(placed), dtype=np.float64)
    return Trajectory(stamp_ns, frame_id, times, placed, commands)


def _legs(offset: Pose2) -> list[_Leg]:
    """Legs from ``offset`` to the origin with heading zero, in the frame of the goal."""
    x, y, yaw = offset.x_m, offset.y_m, offset.yaw_rad
    distance = math.hypot(x, y)
    if distance > DIRECT_M:
        forwards = math.atan2(-y, -x)
        bearing, drive = forwards, distance
        backwards = wrap_angle(forwards + math.pi)
        if abs(wrap_angle(backwards - yaw)) + abs(backwards) < abs(wrap_angle(forwards - yaw)) + abs(forwards):
            bearing, drive = backwards, -distance
        turns_and_drives = [_Leg(turn_rad=wrap_angle(bearing - yaw)), _Leg(drive_m=drive), _Leg(turn_rad=-bearing)]
    elif abs(y) < ALIGNED_M:
        turns_and_drives = [_Leg(turn_rad=-yaw), _Leg(drive_m=-x)]
    else:
        slant = math.asin(min(abs(y) / REACH_M, 1.0))
        length = abs(y) / math.sin(slant)
        options = []
        for drive in (-length, length):  # backwards first where both are as long: the last drive is then forwards
            bearing = -math.copysign(slant, y * drive)
            options.append((abs(drive) + abs(x + drive * math.cos(slant)), drive, bearing))
        _, drive, bearing = min(options, key=lambda option: option[0])
        turns_and_drives = [
            _Leg(turn_rad=wrap_angle(bearing - yaw)),
            _Leg(drive_m=drive),
            _Leg(turn_rad=-bearing),
            _Leg(drive_m=-x - drive * math.cos(slant)),
        ]
    return [leg for leg in turns_and_drives if abs(leg.turn_rad) > 1e-3 or abs(leg.drive_m) > 1e-4]


def _sample(leg: _Leg, start: Array, rates: ManoeuvreRates) -> tuple[Array, Array]:
    """Poses (n, 3) and inputs (n, 2) after ``start`` (3,): a raised cosine of speed, then a pause."""
    turning = leg.turn_rad != 0.0
    amount = leg.turn_rad if turning else leg.drive_m
    fastest = rates.yaw_rate_radps if turning else rates.speed_mps
    acceleration = rates.yaw_acceleration_radps2 if turning else rates.acceleration_mps2
    # The mean of a raised cosine is half its peak; its steepest slope is pi peak / duration.
    duration = max(2.0 * abs(amount) / fastest, math.sqrt(2.0 * math.pi * abs(amount) / acceleration))
    moving = math.ceil(duration / SAMPLE_STEP_S)
    phase = np.minimum(np.arange(1, moving + 1 + round(PAUSE_S / SAMPLE_STEP_S)) / moving, 1.0)
    covered = amount * (phase - np.sin(2.0 * math.pi * phase) / (2.0 * math.pi))
    rate = amount / (moving * SAMPLE_STEP_S) * (1.0 - np.cos(2.0 * math.pi * phase))
    rate[phase == 1.0] = 0.0
    poses, inputs = np.tile(start, (len(phase), 1)), np.zeros((len(phase), 2))
    if turning:
        poses[:, 2] += covered
        inputs[:, 1] = rate
    else:
        poses[:, :2] += covered[:, None] * np.array([math.cos(start[2]), math.sin(start[2])])
        inputs[:, 0] = rate
    return poses, inputs
