"""The contract between the nodes: every topic of a drive, who says it to whom, how often and how reliably."""

from dataclasses import dataclass

from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import AccelStamped, TwistStamped
from nav_msgs.msg import Odometry
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import Imu, JointState, LaserScan
from std_msgs.msg import Bool, String
from tf2_msgs.msg import TFMessage
from tracked_interfaces.msg import GoalReached, SafetyState, SlipEstimate, SolverStatus, Trajectory


@dataclass(frozen=True, slots=True)
class Row:
    """One topic.

    publishers: exactly these nodes (recorder and bringup left out everywhere). subscribers: at least these.
    rate_hz: stamps are the instants of this grid, none left out; None: on events. frame: of the header; None: none.
    latched: transient local, for those who come late.
    """

    topic: str
    type: type
    publishers: frozenset[str]
    subscribers: frozenset[str]
    rate_hz: int | None = None
    frame: str | None = None
    latched: bool = False


def row(
    topic: str, kind: type, arrow: str, rate_hz: int | None = None, frame: str | None = None, *, latched: bool = False
) -> Row:
    """A row whose nodes are written ``from, from -> to, to``."""
    ends = [frozenset(name.strip() for name in end.split(",") if name.strip()) for end in arrow.split("->")]
    return Row(topic, kind, ends[0], ends[1], rate_hz, frame, latched)


CONTRACT = (
    row("clock", Clock, "sim_bridge -> ekf, upper_nmpc, lower_nmpc, trajectory_player, command_arbiter", 60),
    row("joint_states", JointState, "sim_bridge -> ekf", 60, ""),
    row("imu/data", Imu, "sim_bridge -> ekf", 120, "imu_link"),
    row("scan", LaserScan, "sim_bridge ->", 10, "laser"),
    row("ground_truth/odom", Odometry, "sim_bridge ->", 60, "world"),
    row("ground_truth/slip", SlipEstimate, "sim_bridge ->", 60, "base_footprint"),
    row("ground_truth/acceleration", AccelStamped, "sim_bridge ->", 60, "world"),
    row("odom", Odometry, "ekf -> upper_nmpc, lower_nmpc, trajectory_player, command_arbiter", 60, "odom"),
    row("slip", SlipEstimate, "ekf -> lower_nmpc", 60, "base_footprint"),
    row("reference_trajectory", Trajectory, "trajectory_player -> upper_nmpc", 5, "odom"),
    row("goal_reached", GoalReached, "trajectory_player ->", latched=True),
    row("upper_nmpc/trajectory", Trajectory, "upper_nmpc -> lower_nmpc", 5, "odom"),
    row("upper_nmpc/status", SolverStatus, "upper_nmpc ->", 5, ""),
    row("lower_nmpc/trajectory", Trajectory, "lower_nmpc ->", 30, "odom"),
    row("lower_nmpc/status", SolverStatus, "lower_nmpc ->", 30, ""),
    row("cmd_vel_nav", TwistStamped, "lower_nmpc -> command_arbiter", 30, "base_footprint"),
    row("cmd_vel_follow", TwistStamped, "-> command_arbiter"),
    row("cmd_vel_teleop", TwistStamped, "-> command_arbiter"),
    row("cmd_vel", TwistStamped, "command_arbiter -> sim_bridge, upper_nmpc, lower_nmpc", 30, "base_footprint"),
    row("e_stop", Bool, "-> command_arbiter"),
    row("safety/state", SafetyState, "command_arbiter ->", latched=True),
    row("tf", TFMessage, "ekf ->"),
    row("tf_static", TFMessage, "description ->", latched=True),
    row("robot_description", String, "description ->", latched=True),
    row(
        "diagnostics",
        DiagnosticArray,
        "sim_bridge, ekf, upper_nmpc, lower_nmpc, trajectory_player, command_arbiter, description ->",
    ),
)
