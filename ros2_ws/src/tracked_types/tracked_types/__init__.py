"""ROS-free data types shared by every package of the stack.

Conventions (REP-103, REP-105): metres, radians, seconds, x forward, y left, z up, angles wrapped to
(-pi, pi]. Stamps are integer nanoseconds (``stamp_ns``), exact under comparison and equal to what a
ROS header carries. Every type is a frozen dataclass; arrays inside are float64.
"""

from tracked_types.angles import angle_difference, wrap_angle
from tracked_types.arbiter_state import ArbiterMode, ArbiterState, GuardAction
from tracked_types.body_state import BodyState
from tracked_types.command import VelocityCommand
from tracked_types.goal import GoalReached
from tracked_types.imu import ImuSample
from tracked_types.joystick import Joystick
from tracked_types.mover import Mover
from tracked_types.occupancy_map import FREE, OCCUPIED, OCCUPIED_PERCENT, UNKNOWN, OccupancyMap
from tracked_types.odometry import Odometry
from tracked_types.outline import Outline, OutlineKind
from tracked_types.period_grid import PeriodGrid
from tracked_types.plan_timing import PIPELINE_LATENCY_S, PLAN_RATE_HZ
from tracked_types.pose import Pose2
from tracked_types.pose_history import PoseHistory
from tracked_types.pose_sample import PoseSample
from tracked_types.scan import LaserScan
from tracked_types.scan_points import ScanPoints
from tracked_types.setting import check_settings, setting, settings_of
from tracked_types.slip import Slip
from tracked_types.solver_status import SolverStatus
from tracked_types.stamp_order import StampOrder, clock_set_back
from tracked_types.stamped_pose import StampedPose
from tracked_types.stamps import NANOSECONDS_PER_SECOND, seconds_between, to_nanoseconds
from tracked_types.tracks import LEFT_TRACK, RIGHT_TRACK, TrackSample
from tracked_types.traction import Grip, Traction
from tracked_types.trajectory import Trajectory
from tracked_types.twist import Twist2

__all__ = [
    "FREE",
    "LEFT_TRACK",
    "NANOSECONDS_PER_SECOND",
    "OCCUPIED",
    "OCCUPIED_PERCENT",
    "PIPELINE_LATENCY_S",
    "PLAN_RATE_HZ",
    "RIGHT_TRACK",
    "UNKNOWN",
    "ArbiterMode",
    "ArbiterState",
    "BodyState",
    "GoalReached",
    "Grip",
    "GuardAction",
    "ImuSample",
    "Joystick",
    "LaserScan",
    "Mover",
    "OccupancyMap",
    "Odometry",
    "Outline",
    "OutlineKind",
    "PeriodGrid",
    "Pose2",
    "PoseHistory",
    "PoseSample",
    "ScanPoints",
    "Slip",
    "SolverStatus",
    "StampOrder",
    "StampedPose",
    "TrackSample",
    "Traction",
    "Trajectory",
    "Twist2",
    "VelocityCommand",
    "angle_difference",
    "check_settings",
    "clock_set_back",
    "seconds_between",
    "setting",
    "settings_of",
    "to_nanoseconds",
    "wrap_angle",
]
