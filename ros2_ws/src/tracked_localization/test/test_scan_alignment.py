from dataclasses import replace

import numpy as np
import pytest

from tracked_description import load_robot
from tracked_localization.matching.line_world import ROOM
from tracked_localization.matching.scan_alignment import MOST_BEAMS, ScanAlignment, ScanRefused
from tracked_types import Odometry, Pose2, Twist2

STILL, PERIOD_NS = Pose2(0.0, 0.0, 0.0), 10**8
HEIGHT_M = 0.3


def odometry(stamp_ns, pose=STILL, roll=0.0, pitch=0.0):
    known = (Twist2(0.0, 0.0), np.eye(3), np.eye(2))
    return Odometry(stamp_ns, "odom", "base", pose, *known, roll_rad=roll, pitch_rad=pitch)


def tilted_scan(pitch, height_m):
    """What a lidar sees on a robot at the origin of the room whose nose is ``pitch`` below the horizon."""
    level = ROOM.scan(STILL)
    angles = level.angle_min_rad + level.angle_increment_rad * np.arange(len(level.ranges_m))
    ahead, aside, down = np.cos(pitch) * np.cos(angles), np.sin(angles), np.sin(pitch) * np.cos(angles)
    origin = np.array([[np.sin(pitch) * height_m, 0.0]])
    walls = ROOM.cast(origin, np.arctan2(aside, ahead)) / np.hypot(ahead, aside)
    with np.errstate(divide="ignore"):
        floor = np.where(down > 0.0, np.cos(pitch) * height_m / down, np.inf)
    return replace(level, ranges_m=np.minimum(walls, floor).astype(np.float32)), floor < walls


def aligned(alignment, scan, **tilt):
    alignment.add_odometry(odometry(scan.stamp_ns, **tilt))
    (found,) = alignment.add_scan(scan)
    return found.points


def test_a_scan_of_a_pitching_robot_shows_walls_where_they_are_and_no_floor():
    scan, met_floor = tilted_scan(0.1, HEIGHT_M)
    assert met_floor.any()
    levelled = aligned(ScanAlignment(STILL, HEIGHT_M), scan, pitch=0.1)
    assert ROOM.distances(levelled.hits).max() < 1e-3
    assert len(levelled.hits) <= len(scan.ranges_m) - met_floor.sum()
    assert ROOM.distances(aligned(ScanAlignment(STILL), scan, pitch=0.1).hits).max() > 0.2


def test_the_robots_own_lidar_is_levelled_by_its_height_over_the_floor():
    robot = load_robot()
    scan, _ = tilted_scan(0.1, robot.base_link_height_m + robot.lidar.xyz_m[2])
    points = aligned(ScanAlignment.of_robot(robot), scan, pitch=0.1)
    offset = robot.lidar.xyz_m[0] * np.cos(0.1)  # the scan was taken over the origin
    assert ROOM.distances(points.hits - np.array([offset, 0.0])).max() < 1e-3


def test_a_lidar_that_is_mounted_askew_is_refused():
    robot = load_robot()
    askew = robot.model_copy(update={"lidar": robot.lidar.model_copy(update={"rpy_rad": (0.0, 0.3, 0.0)})})
    with pytest.raises(ValueError, match="level"):
        ScanAlignment.of_robot(askew)


@pytest.mark.parametrize("scan_first", [True, False])
def test_the_order_of_arrival_makes_no_difference(scan_first):
    alignment, scan, pose = ScanAlignment(STILL), ROOM.scan(STILL, stamp_ns=PERIOD_NS), Pose2(1.0, 2.0, 0.5)
    if scan_first:
        assert alignment.add_scan(scan) == []
        (found,) = alignment.add_odometry(odometry(PERIOD_NS, pose))
    else:
        assert alignment.add_odometry(odometry(PERIOD_NS, pose)) == []
        (found,) = alignment.add_scan(scan)
    assert found.odom_pose == pose and found.points.stamp_ns == PERIOD_NS


def test_scans_without_odometry_are_dropped_and_counted():
    alignment = ScanAlignment(STILL)
    for index in range(15):
        assert alignment.add_scan(ROOM.scan(STILL, stamp_ns=index * PERIOD_NS)) == []
    assert alignment.uncovered == 5
    assert alignment.add_odometry(odometry(100 * PERIOD_NS)) == [] and alignment.uncovered == 15


def test_a_scan_that_is_not_newer_or_takes_too_long_is_refused_by_name():
    alignment, scan = ScanAlignment(STILL), ROOM.scan(STILL, stamp_ns=PERIOD_NS)
    alignment.add_scan(scan)
    with pytest.raises(ScanRefused, match="stamp"):
        alignment.add_scan(scan)
    with pytest.raises(ScanRefused, match="longer than"):
        alignment.add_scan(replace(scan, stamp_ns=2 * PERIOD_NS, time_increment_s=1.0))


def test_a_huge_scan_is_thinned():
    points = aligned(ScanAlignment(STILL), ROOM.scan(STILL, stamp_ns=PERIOD_NS, beams=3 * MOST_BEAMS))
    assert len(points.hits) <= MOST_BEAMS and ROOM.distances(points.hits).max() < 1e-3


def test_a_clock_that_is_set_back_starts_anew():
    alignment = ScanAlignment(STILL)
    aligned(alignment, ROOM.scan(STILL, stamp_ns=100 * PERIOD_NS))
    assert len(aligned(alignment, ROOM.scan(STILL, stamp_ns=PERIOD_NS)).hits) == 360
    assert alignment.newest_ns == PERIOD_NS
