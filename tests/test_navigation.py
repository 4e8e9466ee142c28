"""The robot is sent to places of a map, over topics and actions, and drives there or says why not."""

import numpy as np
import pytest
from geometry_msgs.msg import PoseStamped
from nav_msgs.msg import Odometry, Path
from rclpy.qos import QoSProfile

from sim_bridge.world import load_world
from tests.support.domains import own_domain
from tests.support.graph_process import GraphProcess
from tests.support.probe import own_probe
from tracked_lab.true_map import true_map
from tracked_localization.mapping.map_files import save_map
from tracked_navigation.robot import Robot

START_LIMIT_S, DRIVE_LIMIT_S = 90.0, 100.0
DEEP = QoSProfile(depth=1000)


@pytest.fixture(scope="module")
def graph(tmp_path_factory):
    """The rooms, with a robot that waits for goals, and a probe; one graph for all tests, which follow one another."""
    folder = tmp_path_factory.mktemp("navigation")
    saved = save_map(true_map(load_world("rooms"), lidar_height_m=0.22), folder / "rooms")
    with own_domain() as domain, own_probe(domain) as probe:
        process = GraphProcess(
            domain,
            folder,
            "navigate",
            f"map_server.map:={saved}",
            "navigator.goals:=[0.0]",
            "world:=rooms",
            "duration_s:=600",
            "nodes.recorder:=false",
        )
        try:
            odometry = probe.collect(Odometry, "odom", DEEP)
            probe.wait_until(
                lambda: odometry or not process.is_running, timeout_s=START_LIMIT_S, what="the graph's odometry"
            )
            assert process.is_running, process.output
            with Robot(context=probe.node.context) as robot:
                yield probe, robot, process
        finally:
            process.end()


def test_goal_that_cannot_be_reached_is_given_up_with_the_reason_and_the_nearest_place(graph):
    _, robot, _ = graph
    result = robot.go_to(4.0, 1.5, 0.0).wait(DRIVE_LIMIT_S)  # the pillar
    assert not result.succeeded and "obstacle" in result.reason
    assert np.hypot(result.nearest[0] - 4.0, result.nearest[1] - 1.5) < 0.9
    assert "outside the map" in robot.go_to(400.0, 1.5, 0.0).wait(DRIVE_LIMIT_S).reason


def test_goals_that_make_no_sense_are_refused_and_the_sender_is_named(graph):
    probe, robot, process = graph
    with pytest.raises(ValueError, match="refuses"):
        robot.go_to(float("nan"), 1.5, 0.0)
    with pytest.raises(ValueError, match="refuses"):
        robot.go_through([])
    publisher = probe.publisher(PoseStamped, "goal_pose")
    wrong = PoseStamped()
    wrong.header.frame_id, wrong.pose.orientation.w = "odom", 1.0

    def refused():
        publisher.publish(wrong)  # the navigator may learn of its publisher, and of its name, later than the test
        return "rejected goal_pose from /test_probe: frame of goal 1 is odom, not map" in process.output

    probe.wait_until(refused, what="the rejection")


def test_robot_drives_past_a_place_to_a_goal_and_a_drive_under_way_can_be_cancelled(graph):
    probe, robot, _ = graph
    plans = probe.collect(Path, "plan", DEEP)
    drive = robot.go_through([(1.5, 1.35, 0.0), (2.0, 1.5, 0.3)])
    result = drive.wait(DRIVE_LIMIT_S)
    assert result.succeeded, result.reason
    assert result.position_error_m <= 0.03 and result.yaw_error_rad <= 0.04
    probe.wait_until(lambda: plans, what="the plan")
    assert plans[0].header.frame_id == "map" and len(plans[0].poses) > 10

    away = robot.go_to(6.8, 1.4, 0.0)
    robot.spin_until(lambda: away.distance_remaining_m < 4.0, DRIVE_LIMIT_S)
    away.cancel()
    cancelled = away.wait(DRIVE_LIMIT_S)
    assert not cancelled.succeeded and "cancelled" in cancelled.reason
    odometry = probe.collect(Odometry, "odom", DEEP)  # of now: the test has not listened while it drove
    probe.wait_until(lambda: len(odometry) > 60, timeout_s=DRIVE_LIMIT_S, what="the stop")
    assert abs(odometry[-1].twist.twist.linear.x) < 0.02


def test_newer_goal_preempts_the_one_before(graph):
    _, robot, _ = graph
    first = robot.go_to(6.8, 1.4, 0.0)
    second = robot.go_to(3.0, 1.0, 0.0)
    assert "pre-empted" in first.wait(DRIVE_LIMIT_S).reason
    assert second.wait(DRIVE_LIMIT_S).succeeded
