"""A planar robot among straight walls whose ground takes what it wants of the belts' motion."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tracked_description import load_robot
from tracked_localization.matching.line_world import CORRIDOR, ROOM
from tracked_localization.witness.settings import WitnessSettings
from tracked_localization.witness.slip_witness import SlipWitness
from tracked_types import Grip, ImuSample, LaserScan, Pose2, TrackSample

ROBOT = load_robot()
LIDAR = Pose2(*ROBOT.lidar.xyz_m[:2], 0.0)


class Robot:
    """Moves by the belts less what is lost; feeds a witness with 120 Hz IMU, 60 Hz belts and 10 Hz instant scans.

    ``imu_last``: of what has one stamp, the IMU's sample comes last and the scan first.
    """

    def __init__(self, world=ROOM, start=Pose2(0.0, 0.5, 0.0), lidar=True, bias=0.004, imu_last=False):  # noqa: B008 - cannot change
        self.witness, self.world, self.lidar, self.bias = (
            SlipWitness(WitnessSettings.from_robot(ROBOT)),
            world,
            lidar,
            bias,
        )
        self.pose, self.tick, self.left, self.right, self.ground = start, 0, 0.0, 0.0, 0.0
        self.imu_last = imu_last
        self.random, self.said, self.steps = np.random.default_rng(3), [], []

    @property
    def now_ns(self):
        return round(self.tick * 1e9 / 120)

    def imu(self, rate, ahead):
        zero = np.zeros((3, 3))
        noise = self.random.standard_normal(6)
        turn = np.array([0.0, 0.0, rate + self.bias]) + 0.01 * noise[:3]
        return ImuSample(self.now_ns, "imu_link", turn, np.array([ahead, 0.0, 9.81]) + 0.05 * noise[3:], zero, zero)

    def scan(self):
        scan = self.world.scan(self.pose.compose(LIDAR), self.random, stamp_ns=self.now_ns)
        self.steps.append(self.witness.add_scan(scan))

    def drive(self, seconds, speed, rate=0.0, *, lost=0.0, multiplier=0.8):
        """Belts at ``speed`` and ``rate``; the list of what the witness said."""
        said = []
        for _ in range(round(seconds * 120)):
            self.tick += 1
            ground, turn = speed * (1.0 - lost), rate * multiplier / 120
            self.pose = self.pose.compose(
                Pose2(ground / 120 * math.cos(turn / 2), ground / 120 * math.sin(turn / 2), turn)
            )
            self.left += (speed - 0.5 * ROBOT.tracks.gauge_m * rate) / 120
            self.right += (speed + 0.5 * ROBOT.tracks.gauge_m * rate) / 120
            inertial, self.ground = self.imu(turn * 120, (ground - self.ground) * 120), ground
            scans = self.lidar and self.tick % 12 == 0
            if not self.imu_last:
                self.witness.add_imu(inertial)
            elif scans:
                self.scan()
            if self.tick % 2 == 0:
                tick_m = ROBOT.tracks.encoder_tick_m
                counted = [math.floor(side / tick_m) * tick_m for side in (self.left, self.right)]
                heard = self.witness.add_tracks(TrackSample(self.now_ns, *counted))
                said += [heard] if heard else []
            if self.imu_last:
                self.witness.add_imu(inertial)
            elif scans:
                self.scan()
        return said


def test_slip_of_both_kinds_is_found_and_follows_a_change_of_the_ground():
    robot = Robot()
    robot.drive(0.5, 0.0)
    first = robot.drive(2.0, 0.4, 0.6, lost=0.05)[-1]
    assert first.traction.lost_share == pytest.approx(
        0.05, abs=0.03
    ) and first.traction.yaw_multiplier == pytest.approx(0.8, abs=0.03)
    second = robot.drive(1.0, 0.4, 0.6, lost=0.3, multiplier=0.5)
    half, last = second[30], second[-1]
    assert half.traction.lost_share == pytest.approx(0.3, abs=0.05) and half.traction.yaw_multiplier == pytest.approx(
        0.5, abs=0.05
    )
    assert last.slip.speed_mps == pytest.approx(-0.12, abs=0.015) and last.slip.speed_measured
    assert last.slip.yaw_rate_radps == pytest.approx(-0.3, abs=0.03)
    assert last.gyro_bias_radps == pytest.approx(0.004, abs=0.003)
    assert {each.traction.grip for each in second} == {Grip.HOLDS}


@pytest.mark.parametrize("lidar", [True, False], ids=["scan", "accelerometer alone"])
@pytest.mark.parametrize("running", [True, False], ids=["runs into a wall", "held from the start"])
def test_a_blocked_robot_is_called_so_within_half_a_second_and_no_longer_than_that_is_true(lidar, running):
    robot = Robot(lidar=lidar)
    robot.drive(1.0, 0.0)
    if running:
        assert all(each.traction.grip is not Grip.BLOCKED for each in robot.drive(2.0, 0.3, lost=0.03))
    held = robot.drive(1.0, 0.3, lost=1.0)
    assert held[29].traction.grip is Grip.BLOCKED and held[-1].traction.grip is Grip.BLOCKED
    assert held[-1].slip.speed_mps == pytest.approx(-0.3, abs=0.03)
    assert "tracks turn, robot does not" in held[-1].traction.reason and held[-1].traction.witness == (
        "scan" if lidar else "imu"
    )
    free = robot.drive(1.0, 0.3)
    assert free[36].traction.grip is Grip.HOLDS and not free[-1].traction.reason


def test_a_robot_that_cannot_turn_is_blocked_by_the_word_of_the_gyro():
    robot = Robot()
    robot.drive(1.0, 0.0)
    held = robot.drive(1.0, 0.0, 0.9, multiplier=0.0)
    assert held[29].traction.grip is Grip.BLOCKED and "imu" in held[29].traction.witness


def test_a_stuck_gyro_does_not_make_a_turning_robot_blocked():
    robot = Robot()
    robot.drive(1.0, 0.0)
    robot.imu = lambda rate, ahead, imu=robot.imu: imu(0.0, ahead)
    assert robot.drive(1.5, 0.0, 0.9)[-1].traction.grip is Grip.HOLDS


def test_rolling_tracks_alone_accuse_nobody():
    robot = Robot(lidar=False)
    for _ in range(240):
        robot.tick += 2
        robot.left += 0.005
        robot.right += 0.005
        said = robot.witness.add_tracks(TrackSample(robot.now_ns, robot.left, robot.right))
    assert said.traction.grip is Grip.HOLDS and not said.slip.known


def test_along_a_corridor_nothing_is_guessed_and_the_variance_grows():
    robot = Robot(world=CORRIDOR, start=Pose2(0.0, 0.1, 0.0))
    robot.drive(0.5, 0.0)
    said = robot.drive(4.0, 0.4, lost=0.4)
    share = np.array([each.traction.lost_share for each in said])
    assert np.abs(share).max() < 0.05
    assert said[-1].traction.lost_share_variance == pytest.approx(0.3**2, rel=0.05)
    along = [step.covariance[0, 0] for step in robot.steps]
    across = [step.covariance[1, 1] for step in robot.steps]
    assert along[-1] > 0.01 > 10.0 * across[-1] and all(np.diff(along) >= -1e-12)
    assert {each.traction.grip for each in said[20:]} == {Grip.HOLDS}


def test_too_few_points_say_nothing():
    robot = Robot(lidar=False)
    robot.drive(0.2, 0.0)
    robot.drive(0.2, 0.3)
    ranges = np.full(360, np.inf, np.float32)
    ranges[:5] = 2.0
    for number in range(2):
        scan = LaserScan(
            robot.now_ns - 10**8 * (2 - number), "laser", -np.pi, np.pi / 180, 0.0, 0.1, 0.15, 18.0, ranges
        )
        step = robot.witness.add_scan(scan)
    assert step.step is None and "nothing" in step.reason


def test_the_pose_drifts_less_than_the_belts_and_its_covariance_says_how_much():
    robot = Robot()
    begin = robot.pose
    robot.drive(0.5, 0.0)
    robot.drive(8.0, 0.3, 0.3, lost=0.3)
    step = robot.steps[-1]
    off = begin.compose(step.pose).inverse().compose(robot.pose)
    assert math.hypot(off.x_m, off.y_m) < 0.06 and abs(off.yaw_rad) < 0.02
    deviation = np.sqrt(np.diag(step.covariance))
    assert 0.0005 < deviation[0] < 0.05


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
def test_samples_that_are_not_finite_are_refused_and_counted(bad):
    robot = Robot(lidar=False)
    robot.drive(0.5, 0.3)
    robot.tick += 2
    assert robot.witness.add_tracks(TrackSample(robot.now_ns, bad, 0.0)) is None
    robot.witness.add_imu(robot.imu(bad, 0.0))
    assert robot.witness.refused == {"tracks: not finite": 1, "imu: not finite": 1}
    assert robot.drive(0.5, 0.3)[-1].slip.known


def test_a_jump_of_a_counter_is_refused_and_a_clock_set_back_begins_anew():
    robot = Robot()
    robot.drive(1.0, 0.3)
    robot.left += 50.0
    robot.drive(0.1, 0.3)
    assert robot.witness.refused == {"tracks: jump": 1}
    robot.tick = 0
    said = robot.drive(1.0, 0.3, lost=0.2)[-1]
    assert robot.witness.refused["clock: set back"] == 1 and said.traction.lost_share == pytest.approx(0.2, abs=0.05)


def test_it_does_not_matter_which_sensor_of_an_instant_is_heard_first():
    robot = Robot(imu_last=True)
    robot.drive(0.5, 0.0)
    said = robot.drive(2.0, 0.4, 0.6, lost=0.15)
    assert said[-1].traction.lost_share == pytest.approx(0.15, abs=0.03)
    assert said[-1].traction.yaw_multiplier == pytest.approx(0.8, abs=0.03)
    assert all(each.slip.known for each in said[1:]) and not robot.witness.refused


def test_late_and_doubled_samples_are_counted_only():
    robot = Robot()
    robot.drive(0.5, 0.3)
    assert robot.witness.add_tracks(TrackSample(robot.now_ns, robot.left, robot.right)) is None
    robot.witness.add_imu(robot.imu(0.0, 0.0))
    assert robot.witness.refused == {"tracks: late": 1, "imu: late": 1}


@settings(max_examples=40, deadline=None)
@given(
    ranges=st.lists(st.floats(width=32, allow_nan=True, allow_infinity=True), max_size=40),
    start=st.floats(-1e9, 1e9),
    increment=st.floats(-1e3, 1e3),
    spacing=st.floats(0.0, 0.01),
)
def test_no_scan_brings_the_witness_down(ranges, start, increment, spacing):
    robot = Robot(lidar=False)
    robot.drive(0.3, 0.3)
    numbers = np.array(ranges, np.float32)
    for _ in range(2):
        robot.drive(0.1, 0.3)
        scan = LaserScan(robot.now_ns - 10**8, "laser", start, increment, spacing, 0.1, 0.15, 18.0, numbers)
        robot.witness.add_scan(scan)
    assert all(math.isfinite(each.traction.lost_share) for each in robot.drive(0.1, 0.3))
