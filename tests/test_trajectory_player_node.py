"""The trajectory player as others see it: pieces of reference, arrival, refusals and a polite end."""

import signal

import numpy as np
import pytest
from diagnostic_msgs.msg import DiagnosticArray
from nav_msgs.msg import Odometry as OdometryMessage
from rclpy.qos import DurabilityPolicy, QoSProfile
from tracked_interfaces.msg import GoalReached
from tracked_interfaces.msg import Trajectory as TrajectoryMessage

from node_kit.conversions import odometry_to_message
from tracked_types import Odometry, PeriodGrid, Pose2, Twist2

NODE = ("tracked_navigation", "trajectory_player", "--ros-args")
GRID = PeriodGrid(60)
LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
START_LIMIT_S = 60.0


def parameters(**values):
    return [argument for name, value in values.items() for argument in ("-p", f"{name}:={value}")]


def odometry(index, x=0.0):
    pose = Pose2(x, 0.0, 0.0)
    made = Odometry(GRID.stamp_ns(index), "odom", "base_footprint", pose, Twist2(0.0, 0.0), np.eye(3), np.eye(2))
    return odometry_to_message(made)


def stamp_ns(message):
    return message.header.stamp.sec * 10**9 + message.header.stamp.nanosec


def running(probe, start_node, **values):
    process = start_node(*NODE, *parameters(**values))
    publisher = probe.node.create_publisher(OdometryMessage, "odom", 100)
    probe.wait_until(publisher.get_subscription_count, timeout_s=START_LIMIT_S, what="the player at odom")
    return process, publisher


def test_reference_and_arrival_follow_the_stamps_of_the_odometry(probe, start_node):
    process, odom = running(probe, start_node, shape="line", length_m=0.4, rest_time_s=0.0)
    pieces = probe.collect(TrajectoryMessage, "reference_trajectory", 100)
    probe.wait_until(lambda: probe.node.count_publishers("reference_trajectory"), what="its reference")
    for index in range(1, 60 * 6):
        odom.publish(odometry(index, x=0.4 if index > 240 else 0.0))
        if index % 12 == 0:
            probe.wait_until(lambda index=index: stamp_ns(pieces[-1]) == GRID.stamp_ns(index) if pieces else False)
    late = probe.collect(GoalReached, "goal_reached", LATCHED)
    probe.wait_until(lambda: late, what="the arrival, told to a late subscriber")
    assert [stamp_ns(piece) % 200_000_000 for piece in pieces] == [0] * len(pieces)
    assert all(piece.header.frame_id == "odom" and len(piece.x) == 61 for piece in pieces)
    assert pieces[-1].x[0] == pytest.approx(0.4) and max(pieces[-1].speed) == 0.0
    assert late[0].trajectory == "line" and late[0].position_error < 0.01
    assert process.stop(signal.SIGINT) == 0


def test_a_malformed_odometry_is_refused_by_name_and_survived(probe, start_node):
    _, odom = running(probe, start_node, shape="circle")
    diagnostics = probe.collect(DiagnosticArray, "diagnostics", 100)
    pieces = probe.collect(TrajectoryMessage, "reference_trajectory", 100)
    broken = odometry(30)
    broken.pose.pose.position.x = float("nan")

    def refused():
        odom.publish(broken)
        statuses = [status for message in diagnostics for status in message.status if status.name.endswith("inputs")]
        return any("rejected" in status.message and "/test_probe" in status.message for status in statuses)

    probe.wait_until(refused, what="the refusal")
    odom.publish(odometry(60))
    probe.wait_until(lambda: pieces, what="a piece of reference")
    assert np.isfinite(pieces[0].x).all()


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({"shape": "circle", "radius_m": 0.2}, "needs a yaw rate"),
        ({"shape": "triangle"}, "shape must be one of"),
        ({"loop": "true", "shape": "line"}, "only a closed trajectory"),
        ({"trajectory_file": "/no/such.csv"}, "cannot be read"),
    ],
)
def test_what_cannot_be_driven_stops_the_start_with_the_reason(start_node, values, words):
    process = start_node(*NODE, *parameters(**values))
    assert process.wait(START_LIMIT_S) == 2
    assert words in process.output


def test_a_file_is_refused_by_its_line(start_node, tmp_path):
    path = tmp_path / "path.csv"
    path.write_text("time_s,x_m,y_m,yaw_rad\n0,0,0,0\n1,0.1,0,0\n1,0.2,0,0\n")
    process = start_node(*NODE, *parameters(trajectory_file=path))
    assert process.wait(START_LIMIT_S) == 2
    assert "line 4: time_s 1 repeats that of line 3" in process.output
