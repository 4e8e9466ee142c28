"""Fixtures: one good value of every message family; a ROS context that no other process can see."""

import math
import os
import time
from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

import pytest

# Read when a message is first imported: wrong field types become errors instead of garbage on the wire.
os.environ["ROS_PYTHON_CHECK_FIELDS"] = "1"

import numpy as np
import rclpy
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import PoseStamped, PoseWithCovarianceStamped, Twist, TwistStamped
from nav_msgs.msg import OccupancyGrid
from nav_msgs.msg import Odometry as OdometryMessage
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import Imu, JointState, Joy
from sensor_msgs.msg import LaserScan as LaserScanMessage
from std_msgs.msg import Bool, String
from tracked_interfaces.msg import GoalReached as GoalReachedMessage
from tracked_interfaces.msg import SafetyState, SlipEstimate
from tracked_interfaces.msg import SolverStatus as SolverStatusMessage
from tracked_interfaces.msg import Traction as TractionMessage
from tracked_interfaces.msg import Trajectory as TrajectoryMessage

from node_kit import conversions
from tracked_types import (
    ArbiterMode,
    ArbiterState,
    GoalReached,
    Grip,
    GuardAction,
    ImuSample,
    Joystick,
    LaserScan,
    OccupancyMap,
    Odometry,
    Pose2,
    PoseSample,
    Slip,
    SolverStatus,
    StampedPose,
    TrackSample,
    Traction,
    Trajectory,
    Twist2,
    VelocityCommand,
)

WAIT_LIMIT_S = 10.0
STAMP_NS = 12_345_678_901
DIAGONAL = np.diag([1e-4, 2e-4, 3e-4])
RADIUS_M = 0.04

IMU = ImuSample(STAMP_NS, "imu_link", np.array([0.1, -0.2, 0.3]), np.array([0.0, 0.1, 9.81]), DIAGONAL, DIAGONAL)
ODOMETRY = Odometry(
    STAMP_NS,
    "odom",
    "base_footprint",
    Pose2(1.0, -2.0, 3.0),
    Twist2(0.3, -0.4),
    np.array([[0.02, 0.001, 0.0], [0.001, 0.03, -0.002], [0.0, -0.002, 0.01]]),
    np.array([[0.01, 0.001], [0.001, 0.02]]),
    0.05,
    -0.1,
)
TRAJECTORY = Trajectory(
    STAMP_NS,
    "odom",
    np.array([0.0, 0.2, 0.4]),
    np.array([[0.0, 0.0, 0.0], [0.1, 0.0, 1.0], [0.2, 0.1, -3.0]]),
    np.array([[0.3, 0.0], [0.3, 0.1], [0.0, 0.0]]),
)
SCAN = LaserScan(
    STAMP_NS,
    "laser",
    -math.pi,
    2.0 * math.pi / 360.0,
    0.0,
    0.1,
    0.15,
    18.0,
    np.concatenate([np.linspace(0.5, 5.0, 357), [np.inf, np.nan, -np.inf]]).astype(np.float32),
)

FAMILIES = {
    "imu": (IMU, Imu, conversions.imu_to_message, conversions.imu_from_message),
    "tracks": (
        TrackSample(STAMP_NS, 1.0, -2.0, 0.3, -0.4),
        JointState,
        partial(conversions.tracks_to_message, wheel_radius_m=RADIUS_M),
        partial(conversions.tracks_from_message, wheel_radius_m=RADIUS_M),
    ),
    "odometry": (ODOMETRY, OdometryMessage, conversions.odometry_to_message, conversions.odometry_from_message),
    "pose_sample": (
        PoseSample(STAMP_NS, "odom", Pose2(1.0, -2.0, 3.0), DIAGONAL),
        PoseWithCovarianceStamped,
        conversions.pose_sample_to_message,
        conversions.pose_sample_from_message,
    ),
    "pose_stamped": (
        StampedPose(STAMP_NS, "map", Pose2(1.0, -2.0, 3.0)),
        PoseStamped,
        conversions.pose_stamped_to_message,
        conversions.pose_stamped_from_message,
    ),
    "occupancy_grid": (
        OccupancyMap("map", 0.05, Pose2(-1.0, 2.0, 0.3), np.array([[-1, 0, 100], [65, 30, 1]], np.int8)),
        OccupancyGrid,
        conversions.occupancy_grid_to_message,
        conversions.occupancy_grid_from_message,
    ),
    "slip": (
        Slip(STAMP_NS, 0.01, -0.2, 1e-4, 2e-4, True, True),
        SlipEstimate,
        partial(conversions.slip_to_message, frame_id="base_footprint"),
        conversions.slip_from_message,
    ),
    "traction": (
        Traction(STAMP_NS, Grip.BLOCKED, "scan", "held", 1.0, 1e-3, 0.8, 2e-3),
        TractionMessage,
        partial(conversions.traction_to_message, frame_id="base_footprint"),
        conversions.traction_from_message,
    ),
    "trajectory": (
        TRAJECTORY,
        TrajectoryMessage,
        conversions.trajectory_to_message,
        conversions.trajectory_from_message,
    ),
    "command": (
        VelocityCommand(STAMP_NS, Twist2(0.3, -0.4)),
        TwistStamped,
        conversions.command_to_message,
        conversions.command_from_message,
    ),
    "twist": (Twist2(0.3, -0.4), Twist, conversions.twist_to_message, conversions.twist_from_message),
    "scan": (SCAN, LaserScanMessage, conversions.scan_to_message, conversions.scan_from_message),
    "joystick": (
        Joystick(STAMP_NS, (0.5, -1.0), (True, False, True)),
        Joy,
        conversions.joystick_to_message,
        conversions.joystick_from_message,
    ),
    "clock": (STAMP_NS, Clock, conversions.clock_to_message, conversions.clock_from_message),
    "solver_status": (
        SolverStatus(STAMP_NS, "lower", True, "", 4, 0.25, 1e-4),
        SolverStatusMessage,
        conversions.solver_status_to_message,
        conversions.solver_status_from_message,
    ),
    "safety_state": (
        ArbiterState(
            STAMP_NS, ArbiterMode.STOPPING, "nav", "nav silent", GuardAction.SLOWING, "an obstacle is in the way", 0.25
        ),
        SafetyState,
        conversions.safety_state_to_message,
        conversions.safety_state_from_message,
    ),
    "goal_reached": (
        GoalReached(STAMP_NS, "line", 0.01, -0.02),
        GoalReachedMessage,
        conversions.goal_reached_to_message,
        conversions.goal_reached_from_message,
    ),
    "bool": (True, Bool, conversions.bool_to_message, conversions.bool_from_message),
    "string": ("crawler", String, conversions.string_to_message, conversions.string_from_message),
}


class Graph:
    """Nodes of one test on one executor."""

    def __init__(self, context: Context) -> None:
        self.context = context
        self._executor = SingleThreadedExecutor(context=context)
        self._nodes: list[Any] = []

    def add(self, node_class: Callable[..., Any], *arguments: str, **options: Any) -> Any:
        """Make a node as if the user had given ``arguments`` after --ros-args."""
        node = node_class(context=self.context, cli_args=["--ros-args", *arguments], **options)
        self._nodes.append(node)
        self._executor.add_node(node)
        return node

    def plain(self, name: str) -> Any:
        """A plain rclpy node."""
        return self.add(lambda **options: rclpy.create_node(name, **options))

    def statuses(self) -> dict[str, Any]:
        """Newest diagnostic status by name, growing while the graph spins."""
        newest: dict[str, Any] = {}

        def collect(message: DiagnosticArray) -> None:
            newest.update({status.name: status for status in message.status})

        self.plain("monitor").create_subscription(DiagnosticArray, "diagnostics", collect, 10)
        return newest

    def spin_until(self, condition: Callable[[], Any], what: str) -> Any:
        """Serve until ``condition()`` holds; returns what it returned."""
        deadline_s = time.monotonic() + WAIT_LIMIT_S
        while not (result := condition()):
            assert time.monotonic() < deadline_s, f"waited in vain for {what}"
            self._executor.spin_once(timeout_sec=0.05)
        return result

    def close(self) -> None:
        """Destroy all nodes."""
        for node in self._nodes:
            self._executor.remove_node(node)
            node.destroy_node()
        self._executor.shutdown()


@pytest.fixture
def graph(monkeypatch: pytest.MonkeyPatch) -> Iterator[Graph]:
    """A graph whose participant finds nobody outside its process."""
    monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "OFF")
    context = Context()
    rclpy.init(context=context, args=[])
    made = Graph(context)
    yield made
    made.close()
    context.try_shutdown()


@pytest.fixture(scope="session")
def families() -> dict[str, Any]:
    """Per message family: a good value, its message type, and the conversions to and from it."""
    return FAMILIES
