"""The slip witness as others see it: a robot that is held is called so, bad input is named, poses are of scans."""

import math
import signal
from array import array

import numpy as np
import pytest
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import PoseWithCovarianceStamped
from nav_msgs.msg import Odometry as OdometryMessage
from rclpy.qos import QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import Imu, JointState
from sensor_msgs.msg import LaserScan as LaserScanMessage
from tracked_interfaces.msg import Traction as TractionMessage

from node_kit import qos
from node_kit.conversions import (
    imu_to_message,
    odometry_to_message,
    pose_sample_from_message,
    scan_to_message,
    tracks_to_message,
    traction_from_message,
)
from tests.support.domains import own_domain
from tests.support.node_process import NodeProcess
from tests.support.probe import own_probe
from tracked_description import load_robot
from tracked_localization.matching.line_world import ROOM
from tracked_types import Grip, ImuSample, Odometry, PeriodGrid, Pose2, TrackSample, Twist2

ROBOT = load_robot()
LIDAR = Pose2(*ROBOT.lidar.xyz_m[:2], 0.0)
GRID = PeriodGrid(ROBOT.imu.rate_hz)
KEEP = QoSProfile(depth=5000, reliability=ReliabilityPolicy.RELIABLE)
START = Pose2(0.0, 0.5, 0.0)


class Held:
    """A robot in a room whose ground gives back a share of what the belts roll, and the node that watches it."""

    def __init__(self, probe, process):
        self.probe, self.process = probe, process
        self.tractions = probe.collect(TractionMessage, "traction", KEEP)
        self.poses = probe.collect(PoseWithCovarianceStamped, "pose", KEEP)
        self.reports = probe.collect(DiagnosticArray, "diagnostics", KEEP)
        self.imu, self.joints = probe.publisher(Imu, "imu/data", qos.STATE), probe.publisher(JointState, "joint_states")
        self.scans = probe.publisher(LaserScanMessage, "scan", qos.STATE)
        self.odometry = probe.publisher(OdometryMessage, "odom", qos.STATE)
        self.random, self.tick, self.travel, self.pose, self.speed = np.random.default_rng(0), 0, 0.0, START, 0.0

    @property
    def stamp_ns(self):
        return GRID.stamp_ns(self.tick)

    def drive(self, seconds, speed, lost=0.0):
        """Go on for so long, never far ahead of what the node says."""
        for _ in range(round(seconds * ROBOT.imu.rate_hz)):
            self.tick += 1
            period_s, ground = 1.0 / ROBOT.imu.rate_hz, speed * (1.0 - lost)
            self.pose = self.pose.compose(Pose2(ground * period_s, 0.0, 0.0))
            self.travel += speed * period_s
            force = np.array([(ground - self.speed) / period_s, 0.0, 9.81]) + 0.02 * self.random.standard_normal(3)
            self.speed, zero = ground, np.zeros((3, 3))
            rates = 0.01 * self.random.standard_normal(3)
            self.imu.publish(imu_to_message(ImuSample(self.stamp_ns, ROBOT.frames.imu, rates, force, zero, zero)))
            if self.tick % 2 == 0:
                self.send_tracks(speed)
            if self.tick % 12 == 0:
                self.scans.publish(
                    scan_to_message(ROOM.scan(self.pose.compose(LIDAR), self.random, stamp_ns=self.stamp_ns))
                )
                self.probe.wait_until(
                    lambda: self.tractions and traction_from_message(self.tractions[-1]).stamp_ns >= self.stamp_ns,
                    what=f"traction at {self.stamp_ns}; {self.process.output[-1500:]}",
                )

    def send_tracks(self, speed):
        tracks = TrackSample(self.stamp_ns, self.travel, self.travel, speed, speed)
        self.joints.publish(tracks_to_message(tracks, wheel_radius_m=ROBOT.tracks.wheel_radius_m))
        believed = Odometry(
            self.stamp_ns,
            "odom",
            "base_footprint",
            START.inverse().compose(self.pose),
            Twist2(speed, 0.0),
            np.eye(3),
            np.eye(2),
        )
        self.odometry.publish(odometry_to_message(believed))

    def told(self, task, words):
        """Whether any report on a task has these words."""
        return any(
            words in status.message
            for report in self.reports
            for status in report.status
            if status.name == f"slip_witness: {task}"
        )


@pytest.fixture(scope="module")
def held(tmp_path_factory):
    folder = tmp_path_factory.mktemp("slip_witness")
    with own_domain() as domain, own_probe(domain) as probe:
        process = NodeProcess(
            (
                "tracked_localization",
                "slip_witness",
                "--ros-args",
                "-p",
                "feed_pose:=true",
                "-p",
                "reliable_sensors:=true",
            ),
            folder / "node.log",
            {"ROS_DOMAIN_ID": str(domain)},
        )
        try:
            yield Held(probe, process)
        finally:
            process.end()


def test_a_robot_that_is_held_is_called_blocked_within_half_a_second_and_free_again(held):
    held.drive(0.5, 0.0)
    held.drive(1.5, 0.3, lost=0.1)
    tractions = [traction_from_message(message) for message in held.tractions]
    assert all(each.grip is not Grip.BLOCKED for each in tractions)
    assert tractions[-1].lost_share == pytest.approx(0.1, abs=0.05)
    stopped_ns = held.stamp_ns
    held.drive(0.7, 0.3, lost=1.0)
    blocked = next(each for each in map(traction_from_message, held.tractions) if each.grip is Grip.BLOCKED)
    assert 0.0 < blocked.stamp_ns - stopped_ns <= 0.5e9 and "tracks turn, robot does not" in blocked.reason
    held.probe.wait_until(lambda: held.told("traction", "tracks turn, robot does not"), what="a report")
    held.drive(0.7, 0.3)
    assert traction_from_message(held.tractions[-1]).grip is Grip.HOLDS


def test_the_pose_that_it_feeds_is_where_scans_show_the_robot(held):
    held.drive(0.3, 0.2, lost=0.5)
    held.probe.wait_until(
        lambda: held.poses and pose_sample_from_message(held.poses[-1]).stamp_ns == held.stamp_ns, what="a pose"
    )
    sample, truth = pose_sample_from_message(held.poses[-1]), START.inverse().compose(held.pose)
    assert sample.frame_id == "odom"
    assert math.hypot(sample.pose.x_m - truth.x_m, sample.pose.y_m - truth.y_m) < 0.03
    assert np.linalg.eigvalsh(sample.covariance).min() > 0.0


def test_scans_that_cannot_be_used_are_named_and_the_next_good_one_counts(held):
    for name, value in (
        ("ranges", array("f", [math.nan] * 360)),
        ("angle_increment", 1e9),
        ("angle_increment", 0.0),
        ("range_max", math.nan),
    ):
        message = scan_to_message(ROOM.scan(held.pose.compose(LIDAR), stamp_ns=held.stamp_ns + 1))
        setattr(message, name, value)
        held.scans.publish(message)
    strange = scan_to_message(ROOM.scan(held.pose.compose(LIDAR), stamp_ns=held.stamp_ns + 1))
    strange.header.frame_id = "another"
    held.scans.publish(strange)
    held.drive(0.6, 0.3)
    held.probe.wait_until(lambda: held.told("inputs", "scan"), what="inputs named")
    assert traction_from_message(held.tractions[-1]).grip is Grip.HOLDS


def test_it_ends_politely(held):
    held.process.send(signal.SIGINT)
    assert held.process.wait() == 0
