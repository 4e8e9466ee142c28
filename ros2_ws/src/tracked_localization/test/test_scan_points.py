from dataclasses import replace

import numpy as np
import pytest

from tracked_localization.matching.line_world import ROOM
from tracked_types import Odometry, Pose2, Twist2, to_nanoseconds
from tracked_types.pose_history import PoseHistory
from tracked_types.scan_points import scan_points

STILL = Pose2(0.0, 0.0, 0.0)


def history(speed_mps, yaw_rate_radps, first_s=0.0, last_s=0.2):
    kept = PoseHistory()
    for time_s in np.arange(first_s, last_s + 1e-9, 1 / 60):
        yaw = yaw_rate_radps * time_s
        along = speed_mps * time_s if yaw_rate_radps == 0.0 else speed_mps / yaw_rate_radps * np.sin(yaw)
        aside = 0.0 if yaw_rate_radps == 0.0 else speed_mps / yaw_rate_radps * (1.0 - np.cos(yaw))
        pose, twist = Pose2(along, aside, yaw), Twist2(speed_mps, yaw_rate_radps)
        kept.add(Odometry(to_nanoseconds(time_s), "odom", "base", pose, twist, np.eye(3), np.eye(2)))
    return kept


def swept(speed_mps, yaw_rate_radps):
    """A scan whose beams fire one after the other from a moving robot, over 0.1 s."""
    beams, kept = [], history(speed_mps, yaw_rate_radps)
    for beam in range(360):
        x, y, yaw = kept.at(np.array([to_nanoseconds(beam * 0.1 / 360)]))[0]
        beams.append(ROOM.scan(Pose2(x, y, yaw)).ranges_m[beam])
    return replace(ROOM.scan(STILL), ranges_m=np.array(beams), time_increment_s=0.1 / 360)


@pytest.mark.parametrize(("speed", "turn"), [(0.5, 0.0), (0.0, 1.3), (0.4, -1.3)])
def test_a_scan_of_a_moving_robot_shows_the_room_as_it_is(speed, turn):
    skewed, kept = swept(speed, turn), history(speed, turn)
    points = scan_points(skewed, STILL, kept)
    middle = Pose2(*kept.at(np.array([points.stamp_ns]))[0])
    assert ROOM.distances(middle.transform(points.hits)).max() < 1e-3
    assert ROOM.distances(middle.transform(scan_points(skewed, STILL).hits)).max() > 0.02
    assert points.stamp_ns == pytest.approx(0.05e9, abs=0.2e6)


def test_beams_that_say_nothing_are_left_out_and_the_mounting_counts():
    ranges = np.array([1.0, np.nan, -np.inf, np.inf, 0.01, 99.0], np.float32)
    scan = replace(ROOM.scan(STILL), ranges_m=ranges, angle_min_rad=0.0, angle_increment_rad=np.pi / 2)
    points = scan_points(scan, Pose2(0.1, 0.0, np.pi / 2))
    assert points.hits == pytest.approx(np.array([[0.1, 1.0]]))
    assert points.misses == pytest.approx(np.array([[18.1, 0.0]]))
    assert points.origin == (0.1, 0.0)


def test_a_history_does_not_make_up_what_is_out_of_reach():
    kept = history(0.5, 0.0)
    assert kept.at(np.array([to_nanoseconds(0.3)]))[0, 0] == pytest.approx(0.15)
    assert kept.at(np.array([to_nanoseconds(0.5)])) is None
    assert kept.at(np.array([to_nanoseconds(-0.3)])) is None
    assert PoseHistory().at(np.array([0])) is None


def test_headings_of_a_history_go_on_across_the_half_turn():
    kept = PoseHistory()
    for index, yaw in enumerate((3.1, -3.1)):
        pose = Pose2(0.0, 0.0, yaw)
        kept.add(Odometry(index * 10**8, "odom", "base", pose, Twist2(0.0, 0.0), np.eye(3), np.eye(2)))
    assert kept.at(np.array([5 * 10**7]))[0, 2] == pytest.approx(np.pi)


def test_an_empty_scan_is_no_points():
    points = scan_points(replace(ROOM.scan(STILL), ranges_m=np.zeros(0, np.float32)), STILL)
    assert points.hits.shape == (0, 2) and points.misses.shape == (0, 2)
