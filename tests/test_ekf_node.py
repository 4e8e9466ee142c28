"""The odometry filter's node as others see it: estimates at their instants, frames, culprits, reset, a polite end."""

import math
import signal
from itertools import pairwise

import numpy as np
import pytest
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import PoseWithCovarianceStamped
from nav_msgs.msg import Odometry as OdometryMessage
from sensor_msgs.msg import Imu, JointState
from std_srvs.srv import Trigger
from tf2_msgs.msg import TFMessage
from tracked_interfaces.msg import SlipEstimate

from node_kit import qos
from node_kit.conversions import imu_to_message, pose_sample_to_message, tracks_to_message
from tracked_description import load_robot
from tracked_types import ImuSample, PeriodGrid, Pose2, PoseSample, TrackSample

ROBOT = load_robot()
IMU_GRID = PeriodGrid(ROBOT.imu.rate_hz)
START_LIMIT_S = 60.0
SPEED_MPS, YAW_RATE_RADPS = 0.3, 0.4


class Sensors:
    """IMU and encoders of a robot on an arc; each ``step`` is one odometry period."""

    def __init__(self, probe, prefix=""):
        self.imu = probe.node.create_publisher(Imu, "imu/data", qos.STATE)
        self.tracks = probe.node.create_publisher(JointState, "joint_states", qos.STATE)
        self.frame = f"{prefix}{ROBOT.frames.imu}"
        self.random = np.random.default_rng(0)
        self.index = 0

    def step(self, imu=True):
        for _ in range(2):
            self.index += 1
            if imu:
                self.imu.publish(imu_to_message(self.imu_sample()))
        self.tracks.publish(tracks_to_message(self.track_sample(), wheel_radius_m=ROBOT.tracks.wheel_radius_m))

    @property
    def stamp_ns(self):
        """Stamp of the last step."""
        return IMU_GRID.stamp_ns(self.index)

    def imu_sample(self):
        rate = np.array([0.0, 0.0, YAW_RATE_RADPS]) + 0.01 * self.random.standard_normal(3)
        force = np.array([0.0, 0.0, 9.81])
        return ImuSample(self.stamp_ns, self.frame, rate, force, np.eye(3) * 1e-4, np.eye(3) * 1e-3)

    def track_sample(self):
        time_s = self.index / ROBOT.imu.rate_hz
        half = 0.5 * ROBOT.tracks.gauge_m * YAW_RATE_RADPS / 0.8
        left, right = SPEED_MPS - half, SPEED_MPS + half
        travels = [math.floor(speed * time_s / ROBOT.tracks.encoder_tick_m) for speed in (left, right)]
        travels = [count * ROBOT.tracks.encoder_tick_m for count in travels]
        return TrackSample(self.stamp_ns, *travels, left, right)


@pytest.fixture
def driven(probe, start_node):
    """``driven(steps, *arguments)``: the process, its sensors and its odometry after so many periods."""

    def drive(steps, *arguments, prefix=""):
        # Nobody publishes a clock: for the node no time passes but that of the stamps.
        process = start_node("tracked_localization", "ekf", "--ros-args", "-p", "use_sim_time:=true", *arguments)
        odometry = probe.collect(OdometryMessage, "odom", 100)
        sensors = Sensors(probe, prefix)
        for publisher in (sensors.imu, sensors.tracks):
            probe.wait_until(publisher.get_subscription_count, timeout_s=START_LIMIT_S, what="the node at its sensors")

        def answered():
            sensors.step()
            return odometry

        # The first answers may leave before they have met their reader.
        probe.wait_until(answered, what="its odometry")
        probe.wait_until(lambda: stamp_ns(odometry[-1]) == sensors.stamp_ns, what="all of its odometry")
        run(probe, sensors, odometry, steps)
        return process, sensors, odometry

    return drive


def run(probe, sensors, odometry, steps, **options):
    """Step the sensors, each time after the answer to the last."""
    for _ in range(steps):
        known = len(odometry)
        sensors.step(**options)
        probe.wait_until(lambda known=known: len(odometry) > known, what="the next odometry")


def stamp_ns(message):
    return message.header.stamp.sec * 10**9 + message.header.stamp.nanosec


def status_of(reports, level):
    """Newest report on the odometry if it has this level."""
    found = [status for report in reports for status in report.status if status.name.endswith("odometry")]
    return found[-1] if found and found[-1].level == level else None


def test_estimates_come_at_their_instants_with_slip_and_transform_in_prefixed_frames(probe, driven):
    slips, transforms = probe.collect(SlipEstimate, "slip", 100), probe.collect(TFMessage, "tf", 100)
    _, _, odometry = driven(60, "-p", "frame_prefix:=robot1/", prefix="robot1/")
    grid = PeriodGrid(ROBOT.odometry.rate_hz)
    stamps = [stamp_ns(message) for message in odometry]
    assert stamps == [grid.stamp_ns(grid.index_at(stamps[0]) + index) for index in range(len(stamps))]
    last = odometry[-1]
    assert (last.header.frame_id, last.child_frame_id) == ("robot1/odom", "robot1/base_footprint")
    assert last.twist.twist.linear.x == pytest.approx(SPEED_MPS, abs=0.02)
    assert last.twist.twist.angular.z == pytest.approx(YAW_RATE_RADPS, abs=0.05)
    probe.wait_until(lambda: slips and transforms and stamp_ns(slips[-1]) == stamps[-1], what="slip and transform")
    assert slips[-1].known
    assert np.median([slip.yaw_rate for slip in slips]) == pytest.approx(-0.25 * YAW_RATE_RADPS, abs=0.02)
    moved = transforms[-1].transforms[0]
    assert (moved.header.frame_id, moved.child_frame_id) == ("robot1/odom", "robot1/base_footprint")
    assert moved.transform.translation.x == pytest.approx(last.pose.pose.position.x, abs=0.01)


def test_silent_imu_is_named_on_diagnostics_while_odometry_goes_on(probe, driven):
    reports = probe.collect(DiagnosticArray, "diagnostics", 100)
    _, sensors, odometry = driven(30)
    sensors.step(imu=False)
    run(probe, sensors, odometry, 30, imu=False)
    status = probe.wait_until(lambda: status_of(reports, b"\x01"), what="a warning")
    assert "imu: silent" in status.message


def test_a_pose_of_the_past_corrects_the_odometry_of_now_where_the_node_is_told_to_listen(probe, driven):
    poses = probe.node.create_publisher(PoseWithCovarianceStamped, "pose", qos.STATE)
    reports = probe.collect(DiagnosticArray, "diagnostics", 100)
    _, sensors, odometry = driven(60, "-p", "fuse_pose:=true")
    probe.wait_until(poses.get_subscription_count, what="the node at its poses")
    past, known = odometry[-6], len(odometry)
    yaw = 2.0 * math.atan2(past.pose.pose.orientation.z, past.pose.pose.orientation.w)
    pose = Pose2(past.pose.pose.position.x, past.pose.pose.position.y, yaw).compose(Pose2(0.01, 0.0, 0.0))

    def leapt():
        # The node listens as best effort: what is lost is sent again, and a duplicate does not count.
        for frame in ("map", ROBOT.frames.odom):
            poses.publish(pose_sample_to_message(PoseSample(stamp_ns(past), frame, pose, np.diag([1e-8, 1e-8, 1e-4]))))
        run(probe, sensors, odometry, 1)
        places = [(message.pose.pose.position.x, message.pose.pose.position.y) for message in odometry[known - 1 :]]
        return max(math.dist(*pair) for pair in pairwise(places)) > SPEED_MPS / ROBOT.odometry.rate_hz + 0.005

    probe.wait_until(leapt, what="the correction")
    told = [status for report in reports for status in report.status if status.name.endswith("inputs")]
    assert any("pose" in status.message for status in told), "the pose in another frame is complained about"


def test_reset_service_puts_the_odometry_back_to_the_origin_and_a_signal_ends_the_node_politely(probe, driven):
    process, sensors, odometry = driven(60)
    assert odometry[-1].pose.pose.position.x > 0.2
    assert probe.call(Trigger, "reset_odometry").success
    run(probe, sensors, odometry, 1)
    assert abs(odometry[-1].pose.pose.position.x) < 0.02
    assert process.stop(signal.SIGTERM) == 0


def test_tuning_out_of_range_is_refused_at_the_start(start_node):
    process = start_node("tracked_localization", "ekf", "--ros-args", "-p", "silence_s:=-1.0")
    assert process.wait(START_LIMIT_S) == 2
    assert "silence_s" in process.output
