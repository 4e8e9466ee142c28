"""The slip witness on the plants of the lab, and what its poses do to the odometry."""

import math

import numpy as np
import pytest

from tracked_description import load_robot
from tracked_lab.line_lidar import LineLidar
from tracked_lab.recordings.indoor_loop import load_indoor_loop, overlap_residual_m
from tracked_lab.witness.drives import CIRCLE_START, changing_ground, on_changing_ground
from tracked_lab.witness.witness_track import Columns
from tracked_localization import OdometryFilter, OdometryFilterSettings
from tracked_localization.matching.line_world import ROOM
from tracked_localization.witness.odometry_anchor import OdometryAnchor
from tracked_localization.witness.settings import WitnessSettings
from tracked_localization.witness.slip_witness import SlipWitness
from tracked_types import Pose2

ROBOT = load_robot()


def odometry_errors(*, fed):
    """Position errors (m) of the odometry filter on ground that takes up to 40 % of the way."""
    odometry_filter = OdometryFilter(OdometryFilterSettings.from_robot(ROBOT))
    witness, anchor, errors = SlipWitness(WitnessSettings.from_robot(ROBOT)), OdometryAnchor(), []
    if fed:
        odometry_filter.expect_poses()
    for batch, scan, _ in changing_ground(ROBOT, 1000, 10.0):
        estimates = []
        for sample in batch.imu:
            witness.add_imu(sample)
            estimates += odometry_filter.add_imu(sample)
        for sample in batch.tracks:
            witness.add_tracks(sample)
            estimates += odometry_filter.add_tracks(sample)
        truth = {state.stamp_ns: state.pose for state in batch.truth}
        for estimate in estimates:
            anchor.add_odometry(estimate.odometry)
            if estimate.odometry.stamp_ns in truth:
                off = CIRCLE_START.compose(estimate.odometry.pose).inverse().compose(truth[estimate.odometry.stamp_ns])
                errors.append(math.hypot(off.x_m, off.y_m))
        step = None if scan is None else witness.add_scan(scan)
        pose = None if step is None or step.step is None else anchor.pose(step, ROBOT.frames.odom)
        if fed and pose is not None:
            odometry_filter.add_pose(pose)
    assert not odometry_filter.health.counts
    return np.array(errors)


def test_poses_of_the_scans_take_the_longitudinal_slip_out_of_the_odometry():
    alone, fed = odometry_errors(fed=False), odometry_errors(fed=True)
    assert alone.max() > 0.1 and fed.max() < 0.3 * alone.max() and fed.max() < 0.05


def test_slip_on_changing_ground_is_within_its_figures():
    track, changes = on_changing_ground(ROBOT, 1001, 10.0)
    columns = track.columns()
    times, errors = columns.share_errors()
    settled = np.all([(times < at_s) | (times > at_s + 0.5) for at_s, _, _ in changes], axis=0)
    assert len(changes) == 2 and np.sqrt(np.mean(errors[settled] ** 2)) < 0.03
    assert np.sqrt(np.mean(columns.yaw_errors()[1] ** 2)) < 0.03
    assert columns.false_alarms() == 0


def test_a_lidar_of_lines_stamps_its_first_beam_and_sees_the_room():
    lidar, scans = LineLidar(ROBOT, ROOM, 0, Pose2(0.0, 0.0, 0.0)), []
    for _ in range(24):
        scan = lidar.update(Pose2(0.0, 0.0, 0.0))
        scans += [] if scan is None else [scan]
    assert [scan.stamp_ns for scan in scans] == [0, 100_000_000]
    ahead = float(scans[0].ranges_m[180])
    assert ahead == pytest.approx(5.0 - ROBOT.lidar.xyz_m[0], abs=0.02)


def columns_of(blocked, moved):
    """Belts at 0.3 m/s; ``moved`` is the share that the robot follows, both (n,)."""
    count = len(moved)
    belt, zero = np.full(count, 0.3), np.zeros(count)
    slip = (np.asarray(moved) - 1.0) * belt
    return Columns(np.arange(count) / 60.0, belt, zero, slip, slip, zero, zero, np.asarray(blocked, float), zero)


def test_alarms_are_timed_from_where_the_robot_stood_and_counted_where_it_did_not():
    moved = np.r_[np.ones(60), np.zeros(60), np.ones(60)]
    late = np.r_[np.zeros(75), np.ones(45), np.zeros(60)]
    assert 0.1 < columns_of(late, moved).detected_after_s() < 0.3
    assert columns_of(late, moved).false_alarms() == 0
    assert columns_of(np.zeros(180), moved).detected_after_s() == math.inf
    assert columns_of(np.r_[np.zeros(20), np.ones(10), np.zeros(150)], moved).false_alarms() == 1
    with pytest.raises(ValueError, match="never held"):
        columns_of(np.zeros(180), np.ones(180)).detected_after_s()


def test_the_odometry_of_the_indoor_loop_does_not_come_back_to_its_beginning():
    loop = load_indoor_loop()
    assert len(loop.points) == 225 and loop.duration_s == pytest.approx(59.07, abs=0.01)
    assert overlap_residual_m(loop.points, loop.odometry) > 0.2
    with pytest.raises(ValueError, match="does not come near"):
        overlap_residual_m(loop.points, [Pose2(float(index), 0.0, 0.0) for index in range(225)])
