import math

import numpy as np
import pytest

from tracked_localization.tilt import Tilt
from tracked_types import ImuSample, LaserScan, Odometry, Pose2, PoseHistory, Twist2
from tracked_types.scan_points import scan_points

PERIOD_NS = 1_000_000_000 // 120
GRAVITY = 9.80665
LEVEL = (0.0, 0.0, 0.0)


def sample(index, pitch=0.0, roll=0.0, rates=(0.0, 0.0, 0.0), ahead=0.0):
    up = (-math.sin(pitch), math.cos(pitch) * math.sin(roll), math.cos(pitch) * math.cos(roll))
    force = GRAVITY * np.array(up) + np.array([ahead, 0.0, 0.0])
    return ImuSample(index * PERIOD_NS, "imu_link", np.array(rates), force, np.eye(3), np.eye(3))


def test_a_slope_is_found_at_once_and_a_nose_that_sinks_is_followed_by_the_gyro():
    tilt = Tilt(LEVEL)
    tilt.add(sample(0, pitch=0.2, roll=-0.1))
    assert (tilt.roll_rad, tilt.pitch_rad) == pytest.approx((-0.1, 0.2))
    tilt = Tilt(LEVEL)
    for index in range(61):
        tilt.add(sample(index, pitch=0.5 * index / 120.0, rates=(0.0, 0.5, 0.0)))
    assert tilt.pitch_rad == pytest.approx(0.25, abs=0.01)


def test_a_short_push_is_no_slope():
    tilt = Tilt(LEVEL)
    for index in range(60):
        tilt.add(sample(index, ahead=3.0 if 10 < index < 30 else 0.0))
        assert abs(tilt.pitch_rad) < 0.05


def test_mounting_of_the_imu_is_taken_off():
    tilt = Tilt((0.0, 0.3, 0.0))
    tilt.add(sample(0, pitch=0.3))
    assert tilt.pitch_rad == pytest.approx(0.0, abs=1e-9)


def test_samples_that_make_no_sense_are_left_out():
    tilt = Tilt(LEVEL)
    tilt.add(sample(5, pitch=0.1))
    tilt.add(sample(6, rates=(math.nan, 0.0, 0.0)))
    tilt.add(sample(4, pitch=0.5))
    assert tilt.pitch_rad == pytest.approx(0.1)
    tilt.add(sample(100, pitch=0.3))  # after a gap it begins anew
    assert tilt.pitch_rad == pytest.approx(0.3)


def test_scan_of_a_tilted_robot_is_seen_from_above_and_without_the_floor():
    pitch, height = 0.1, 0.22
    history = PoseHistory()
    odometry = Odometry(0, "odom", "base", Pose2(0.0, 0.0, 0.0), Twist2(0.0, 0.0), np.eye(3), np.eye(2), 0.0, pitch)
    history.add(odometry)
    to_floor = height / math.sin(pitch)
    ranges = np.array([to_floor, 1.0, 2.0, np.inf], np.float32)  # ahead the floor, to the left, behind, to the right
    scan = LaserScan(0, "laser", 0.0, math.pi / 2.0, 1e-9, 0.1, 0.1, 18.0, ranges)
    points = scan_points(scan, Pose2(0.0, 0.0, 0.0), history, height_m=height)
    forward = math.sin(pitch) * height
    expected = [[forward, 1.0], [forward - 2.0 * math.cos(pitch), 0.0]]
    assert points.hits == pytest.approx(np.array(expected), abs=1e-6)
    assert len(points.misses) == 1 and points.origin == pytest.approx((forward, 0.0))
    flat = scan_points(scan, Pose2(0.0, 0.0, 0.0), history)
    assert len(flat.hits) == 3
