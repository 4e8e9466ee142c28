"""Sensors of the odometry filter that fail: they are named, and the others carry on."""

import math
from dataclasses import replace

import numpy as np
import pytest

from tracked_localization import Fault
from tracked_types import ImuSample, PeriodGrid, TrackSample, angle_difference

SECOND = 1_000_000_000
GRID = PeriodGrid(60)


FAULTS = {
    "imu nan": ("imu", Fault.NOT_FINITE),
    "imu stuck": ("imu", Fault.STUCK),
    "imu jumps": ("imu", Fault.JUMP),
    "imu silent": ("imu", Fault.SILENT),
    "imu lossy": ("imu", Fault.LOSSY),
    "tracks nan": ("left_track", Fault.NOT_FINITE),
    "tracks stuck": ("left_track", Fault.STUCK),
    "tracks jump": ("right_track", Fault.JUMP),
    "tracks silent": ("tracks", Fault.SILENT),
    "tracks lossy": ("tracks", Fault.LOSSY),
}


class Corruption:
    """What arrives instead of a tick's samples once the fault has begun."""

    def __init__(self, fault, start_s):
        self.sensor, self.kind = fault.split()
        self.start_ns = start_s * SECOND
        self.frozen = None
        self.count = 0
        self.random = np.random.default_rng(0)

    def __call__(self, tick):
        samples = []
        for sample in tick.samples:
            touched = isinstance(sample, ImuSample) == (self.sensor == "imu")
            if touched and tick.stamp_ns >= self.start_ns:
                sample = self.corrupted(sample)
            elif touched:
                self.frozen = sample
            if sample is not None:
                samples.append(sample)
        return samples

    def corrupted(self, sample):
        self.count += 1
        if self.kind == "silent" or (self.kind == "lossy" and self.random.random() < 0.6):
            return None
        if self.kind == "stuck":
            return replace(self.frozen, stamp_ns=sample.stamp_ns)
        if isinstance(sample, ImuSample) and self.kind in ("nan", "jumps"):
            change = math.nan if self.kind == "nan" else self.random.choice([-1.0, 1.0])
            return replace(sample, angular_velocity_radps=sample.angular_velocity_radps + np.array([0.0, 0.0, change]))
        if self.kind == "nan":
            return replace(sample, left_travel_m=math.nan)
        if self.kind == "jump" and self.count % 10 == 1:
            return replace(sample, right_travel_m=sample.right_travel_m + 0.05)
        return sample


@pytest.mark.parametrize("fault", FAULTS)
@pytest.mark.parametrize("drive", ["straight", "curve", "spot_turn"])
def test_faulty_sensor_is_named_within_half_a_second_and_no_other(odometry_filter, crawler, drives, feed, fault, drive):
    corrupt = Corruption(fault, 2)
    robot = crawler(getattr(drives, drive))
    feed(odometry_filter, robot.run(2.5), corrupt)
    culprits = {(culprit.sensor, culprit.fault) for culprit in odometry_filter.health.culprits}
    sensor, kind = FAULTS[fault]
    assert (sensor, kind) in culprits
    family = {"imu"} if sensor == "imu" else {"tracks", "left_track", "right_track"}
    assert {blamed for blamed, _ in culprits} <= family
    assert str(odometry_filter.health.culprits[0]) in odometry_filter.health.summary


def test_blame_ends_when_the_fault_has_ended(odometry_filter, crawler, drives, feed):
    robot = crawler(drives.curve)
    feed(odometry_filter, robot.run(2.5), Corruption("imu jumps", 2))
    assert odometry_filter.health.blames("imu")
    feed(odometry_filter, robot.run(2.0))
    assert not odometry_filter.health.culprits
    assert odometry_filter.health.counts["imu: jumps"] > 0


@pytest.mark.parametrize("fault", ["imu silent", "tracks silent"])
def test_one_sensor_alone_carries_on_with_growing_covariance(odometry_filter, crawler, drives, feed, fault):
    robot = crawler(drives.curve)
    before = feed(odometry_filter, robot.run(2.0))[-1].odometry
    after = feed(odometry_filter, robot.run(2.0), Corruption(fault, 2))[-1].odometry
    assert odometry_filter.health.advancing
    assert GRID.is_instant(after.stamp_ns) and after.stamp_ns > 3.9 * SECOND
    assert np.linalg.det(after.pose_covariance) > 10.0 * np.linalg.det(before.pose_covariance)
    assert not np.isclose(after.pose.x_m, before.pose.x_m)


def test_without_gyro_the_heading_follows_the_belts(odometry_filter, crawler, drives, feed):
    robot = crawler(drives.curve)
    feed(odometry_filter, robot.run(2.0))
    *_, last = ticks = list(robot.run(2.0))
    pose = feed(odometry_filter, ticks, Corruption("imu silent", 2))[-1].odometry.pose
    assert abs(angle_difference(pose.yaw_rad, last.pose.yaw_rad)) < 0.1


def test_without_any_credible_sensor_the_pose_stays_and_health_says_so(odometry_filter, crawler, drives, feed):
    robot = crawler(drives.straight)
    imu, tracks = Corruption("imu nan", 2), Corruption("tracks nan", 2)

    def both_fail(tick):
        bad = [sample for sample in imu(tick) if isinstance(sample, ImuSample)]
        return bad + [replace(s, right_travel_m=math.nan) for s in tracks(tick) if isinstance(s, TrackSample)]

    feed(odometry_filter, robot.run(2.0))
    poses = [estimate.odometry.pose for estimate in feed(odometry_filter, robot.run(1.0), both_fail)]
    assert not odometry_filter.health.advancing
    assert len(set(poses[10:])) == 1
