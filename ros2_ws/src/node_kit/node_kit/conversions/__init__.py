"""Every conversion between ROS messages and `tracked_types`, one file per message family.

``x_from_message(message)`` checks the message and raises `node_kit.RejectedMessage` with a short reason, nothing else.
``x_to_message(value, into=None)`` returns a new message, or overwrites ``into``, a message it made before.
"""

from node_kit.conversions.body_state import (
    body_state_from_message,
    body_state_to_message,
    vertical_acceleration_from_message,
    vertical_acceleration_to_message,
)
from node_kit.conversions.clock import clock_from_message, clock_to_message
from node_kit.conversions.goal import goal_reached_from_message, goal_reached_to_message
from node_kit.conversions.headers import fill_header, fill_stamp, header_from_message, stamp_from_message
from node_kit.conversions.imu import imu_from_message, imu_to_message
from node_kit.conversions.joystick import joystick_from_message, joystick_to_message
from node_kit.conversions.movers import movers_to_message
from node_kit.conversions.occupancy_grid import occupancy_grid_from_message, occupancy_grid_to_message
from node_kit.conversions.odometry import odometry_from_message, odometry_to_message
from node_kit.conversions.path import path_to_message
from node_kit.conversions.pose_sample import pose_sample_from_message, pose_sample_to_message
from node_kit.conversions.pose_stamped import pose_stamped_from_message, pose_stamped_to_message
from node_kit.conversions.safety_state import safety_state_from_message, safety_state_to_message
from node_kit.conversions.scan import scan_from_message, scan_to_message
from node_kit.conversions.slip import slip_from_message, slip_to_message
from node_kit.conversions.solver_status import solver_status_from_message, solver_status_to_message
from node_kit.conversions.standard import bool_from_message, bool_to_message, string_from_message, string_to_message
from node_kit.conversions.tracks import tracks_from_message, tracks_to_message
from node_kit.conversions.traction import traction_from_message, traction_to_message
from node_kit.conversions.trajectory import trajectory_from_message, trajectory_to_message
from node_kit.conversions.twist import command_from_message, command_to_message, twist_from_message, twist_to_message

__all__ = [
    "body_state_from_message",
    "body_state_to_message",
    "bool_from_message",
    "bool_to_message",
    "clock_from_message",
    "clock_to_message",
    "command_from_message",
    "command_to_message",
    "fill_header",
    "fill_stamp",
    "goal_reached_from_message",
    "goal_reached_to_message",
    "header_from_message",
    "imu_from_message",
    "imu_to_message",
    "joystick_from_message",
    "joystick_to_message",
    "movers_to_message",
    "occupancy_grid_from_message",
    "occupancy_grid_to_message",
    "odometry_from_message",
    "odometry_to_message",
    "path_to_message",
    "pose_sample_from_message",
    "pose_sample_to_message",
    "pose_stamped_from_message",
    "pose_stamped_to_message",
    "safety_state_from_message",
    "safety_state_to_message",
    "scan_from_message",
    "scan_to_message",
    "slip_from_message",
    "slip_to_message",
    "solver_status_from_message",
    "solver_status_to_message",
    "stamp_from_message",
    "string_from_message",
    "string_to_message",
    "tracks_from_message",
    "tracks_to_message",
    "traction_from_message",
    "traction_to_message",
    "trajectory_from_message",
    "trajectory_to_message",
    "twist_from_message",
    "twist_to_message",
    "vertical_acceleration_from_message",
    "vertical_acceleration_to_message",
]
