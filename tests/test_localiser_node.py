"""The localiser as others see it: it finds the robot, follows it, notices when it is elsewhere, and names bad input."""

import math
import signal
from array import array

import numpy as np
import pytest
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import PoseWithCovarianceStamped
from rclpy.qos import QoSProfile, ReliabilityPolicy
from std_msgs.msg import Bool
from std_srvs.srv import Trigger
from tf2_msgs.msg import TFMessage

from node_kit import qos
from node_kit.conversions import pose_sample_from_message, pose_sample_to_message
from tests.support.domains import own_domain
from tests.support.node_process import NodeProcess
from tests.support.probe import own_probe
from tests.support.room_robot import ROBOT, RoomRobot
from tracked_types import Pose2, PoseSample, angle_difference

START = Pose2(1.0, 0.5, 0.3)
KEEP = QoSProfile(depth=2000, reliability=ReliabilityPolicy.RELIABLE)


class Watched:
    """The node's process, a robot in its room, and everything that the node says."""

    def __init__(self, probe, process):
        self.probe, self.process = probe, process
        self.reports = probe.collect(DiagnosticArray, "diagnostics", KEEP)
        self.poses = probe.collect(PoseWithCovarianceStamped, "localisation_pose", KEEP)
        self.measured = probe.collect(PoseWithCovarianceStamped, "pose", KEEP)
        self.transforms = probe.collect(TFMessage, "tf", KEEP)
        self.localised = probe.collect(Bool, "localised", qos.LATCHED)
        self.initial = probe.node.create_publisher(PoseWithCovarianceStamped, "initialpose", qos.STATE)
        self.robot = RoomRobot(probe, START)
        probe.wait_until(
            lambda: self.robot.heard and self.initial.get_subscription_count() and self.localised,
            timeout_s=60.0,
            what="the node",
        )

    def told(self, task, words):
        """Whether the newest report on a task has these words."""
        found = [s for report in self.reports for s in report.status if s.name == f"localiser: {task}"]
        return bool(found) and words in found[-1].message

    def await_told(self, task, words):
        told = [s for r in self.reports for s in r.status]
        self.probe.wait_until(
            lambda: self.told(task, words), what=f"{task}: {words}; {told[-1:]}; {self.process.output[-1500:]}"
        )

    def live(self, seconds, *motion):
        """Let the robot go on, a scan period at a time."""
        for _ in range(round(10.0 * seconds)):
            self.robot.live(0.1, *motion)
            self.probe.spin(0.005)
            if self.measured:  # its odometry follows, as ekf's does
                measured = pose_sample_from_message(self.measured[-1])
                if measured.stamp_ns == self.robot.stamp_ns:
                    self.robot.odom_pose = measured.pose

    def await_localised(self):
        for _ in range(40):
            self.live(0.1)
            if self.localised[-1].data:
                return
            self.probe.spin(0.05)
        raise AssertionError(f"not localised: {self.process.output}")

    def error(self):
        """Of the newest pose, once it is that of the newest scan: metres and radians."""
        self.probe.wait_until(
            lambda: pose_sample_from_message(self.poses[-1]).stamp_ns == self.robot.stamp_ns, what="the newest pose"
        )
        pose, truth = pose_sample_from_message(self.poses[-1]).pose, self.robot.truth
        return math.hypot(pose.x_m - truth.x_m, pose.y_m - truth.y_m), angle_difference(pose.yaw_rad, truth.yaw_rad)

    def say_pose(self, pose, frame="map", covariance=0.04):
        matrix = np.diag([covariance, covariance, covariance])
        self.initial.publish(pose_sample_to_message(PoseSample(self.robot.stamp_ns, frame, pose, matrix)))


@pytest.fixture(scope="module")
def watched(tmp_path_factory):
    """One node for all tests, localised at their beginning but for the first."""
    arguments = ("-p", "reliable_sensors:=true", "-p", "correct_odometry:=true", "-p", "search_again_s:=1.0")
    with own_domain() as domain, own_probe(domain) as probe:
        process = NodeProcess(
            ("tracked_localization", "localiser", "--ros-args", *arguments),
            tmp_path_factory.mktemp("localiser") / "localiser.log",
            {"ROS_DOMAIN_ID": str(domain)},
        )
        try:
            yield Watched(probe, process)
        finally:
            process.end()


def test_without_a_map_it_says_so_and_with_one_it_finds_the_robot_by_itself(watched):
    watched.live(0.3)
    watched.await_told("localisation", "no map")
    assert not watched.localised[-1].data and not watched.poses
    assert watched.probe.call(Trigger, "relocalise").message == "no map"
    watched.robot.send_map({"resolution": -0.05})
    watched.await_told("inputs", "map (not positive: resolution")
    watched.robot.send_map({"width": 2**31, "height": 2**31})
    watched.await_told("inputs", "2147483648 x 2147483648 cells")
    watched.robot.send_map()
    watched.await_localised()
    watched.await_told("localisation", "localised")
    distance_m, turn_rad = watched.error()
    assert distance_m < 0.03 and abs(turn_rad) < 0.02


def test_it_follows_turns_that_odometry_underrates_and_tells_the_odometry_so(watched):
    watched.robot.live(0.0)
    known = len(watched.poses)
    watched.live(1.5, 0.3, 0.8)
    distance_m, turn_rad = watched.error()
    assert distance_m < 0.03 and abs(turn_rad) < 0.02
    assert len(watched.poses) - known == 15, "every scan gives a pose"
    watched.probe.wait_until(
        lambda: pose_sample_from_message(watched.measured[-1]).stamp_ns == watched.robot.stamp_ns,
        what="its measurement",
    )
    measured = pose_sample_from_message(watched.measured[-1])
    assert measured.frame_id == ROBOT.frames.odom
    sent = [t for message in watched.transforms for t in message.transforms]
    assert {(t.header.frame_id, t.child_frame_id) for t in sent} == {("map", ROBOT.frames.odom)}
    anchor = sent[-1].transform
    odom_in_map = Pose2(
        anchor.translation.x, anchor.translation.y, 2.0 * math.atan2(anchor.rotation.z, anchor.rotation.w)
    )
    placed, truth = odom_in_map.compose(measured.pose), watched.robot.truth
    assert math.hypot(placed.x_m - truth.x_m, placed.y_m - truth.y_m) < 0.03
    assert max(np.diag(measured.covariance)) < 0.05**2


def test_a_kidnapped_robot_is_lost_within_two_seconds_and_found_again(watched):
    watched.robot.truth = Pose2(-3.0, -2.0, 1.0)
    watched.live(2.0)
    watched.probe.wait_until(lambda: not watched.localised[-1].data or watched.told("localisation", "localised"))
    assert any(
        "lost" in s.message or "searching" in s.message
        for report in watched.reports
        for s in report.status
        if s.name == "localiser: localisation"
    )
    watched.await_localised()
    assert watched.error()[0] < 0.03


def test_somebody_who_says_where_the_robot_is_is_believed_as_far_as_the_scan_agrees(watched):
    watched.say_pose(watched.robot.truth, frame="odom")
    watched.await_told("inputs", "initialpose (frame is not map")
    watched.robot.truth = Pose2(3.0, 2.0, -2.0)
    watched.say_pose(Pose2(3.2, 1.8, -1.8))
    watched.probe.wait_until(lambda: not watched.localised[-1].data, what="the robot to be unsure")
    watched.await_localised()
    assert watched.error()[0] < 0.03


def test_asked_to_search_it_says_where_the_robot_is(watched):
    answer = watched.probe.call(Trigger, "relocalise")
    truth = watched.robot.truth
    assert answer.success
    x, y = (float(word) for word in answer.message.replace(" m", "").split("x ")[1].split(", yaw")[0].split(", y "))
    assert math.hypot(x - truth.x_m, y - truth.y_m) < 0.05
    watched.await_localised()


@pytest.mark.parametrize(
    ("changed", "reason"),
    [
        ({"angle_increment": 0.0}, "zero: angle_increment"),
        ({"angle_max": 1e9}, "more than two turns: angle_max"),
        ({"ranges": array("f", [1.0, 2.0])}, "size of ranges disagrees with the angles"),
        ({"time_increment": 0.1}, "takes longer than 1 s: scan"),
        ({"range_max": math.nan}, "range_max does not exceed range_min"),
    ],
)
def test_scans_that_cannot_be_used_are_named(watched, changed, reason):
    watched.robot.send_scan(**changed)
    watched.await_told("inputs", f"scan ({reason}")


def test_scans_of_nothing_make_it_lost_and_a_signal_ends_it_politely(watched):
    watched.await_localised()
    watched.robot.blind = True
    watched.live(1.5)
    watched.probe.wait_until(lambda: not watched.localised[-1].data, what="the robot to be lost")
    assert watched.process.stop(signal.SIGTERM) == 0
    assert "Traceback" not in watched.process.output
