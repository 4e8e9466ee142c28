import numpy as np
import pytest

from tracked_localization.mapping.log_odds_grid import LogOddsSettings
from tracked_localization.mapping.mapper import Mapper, MapperSettings
from tracked_localization.matching.line_world import ROOM, LineWorld
from tracked_localization.matching.scan_matcher import MatchSettings
from tracked_types import Pose2, angle_difference
from tracked_types.scan_points import ScanPoints, scan_points

LIDAR = Pose2(0.0, 0.0, 0.0)


def mapper(**options):
    return Mapper(MapperSettings(**options), LogOddsSettings(), MatchSettings())


def circle(loops, steps_per_loop=80, radius_m=1.5):
    """True steps of a drive in circles."""
    turn = 2.0 * np.pi / steps_per_loop
    return [Pose2(radius_m * turn, 0.0, turn)] * (loops * steps_per_loop)


def drive(made, steps, *, start=Pose2(1.0, 0.5, 0.0), lost=0.9, world=ROOM):  # noqa: B008 - a Pose2 cannot change
    """Truth and placement of every scan; odometry sees only a share of each turn. The map's frame is the start."""
    generator, truth, odometry, found = np.random.default_rng(0), start, Pose2(0.0, 0.0, 0.0), []
    for step in steps:
        truth = truth.compose(step)
        odometry = odometry.compose(Pose2(step.x_m, step.y_m, lost * step.yaw_rad))
        placed = made.add(scan_points(world.scan(truth, generator), LIDAR), odometry)
        found.append((start.inverse().compose(truth), placed))
    return found


def test_odometry_that_misses_a_tenth_of_every_turn_does_not_bend_the_map():
    made = mapper()
    found = drive(made, circle(loops=3))
    for truth, placed in found[1:]:
        offset = truth.inverse().compose(found[0][0].compose(found[0][1].pose.inverse()).compose(placed.pose))
        assert np.hypot(offset.x_m, offset.y_m) < 0.03 and abs(offset.yaw_rad) < 0.012
    room = made.as_map()
    occupied = room.centres_of(np.argwhere(room.occupancy > 65))
    world = Pose2(1.0, 0.5, 0.0).compose(found[0][0]).compose(found[0][1].pose.inverse())
    assert (ROOM.distances(world.transform(occupied)) < 0.05).mean() > 0.99


def test_a_scan_that_does_not_fit_is_put_where_odometry_says():
    made = mapper()
    drive(made, circle(loops=1))
    elsewhere = LineWorld(ROOM.walls @ np.array([[0.8, 0.6], [-0.6, 0.8]]) * 0.6)
    before = made.odom_in_map
    placed = made.add(scan_points(elsewhere.scan(Pose2(0.2, 0.1, 0.0)), LIDAR), Pose2(0.0, 0.0, 0.0))
    assert placed.match is None and "scan" in placed.reason
    assert made.odom_in_map == before and placed.pose == before.compose(Pose2(0.0, 0.0, 0.0))


def test_the_first_scan_is_where_the_map_is_told_to_start():
    made = Mapper(MapperSettings(), LogOddsSettings(), MatchSettings(), start=Pose2(3.0, -1.0, 2.0))
    placed = made.add(scan_points(ROOM.scan(LIDAR), LIDAR), Pose2(7.0, 7.0, -1.0))
    assert placed.pose.as_array() == pytest.approx([3.0, -1.0, 2.0]) and placed.match is None


def test_scans_without_a_single_return_move_nothing():
    made = mapper()
    empty = ScanPoints(0, np.zeros((0, 2)), np.zeros((0, 2)), (0.0, 0.0))
    for x in (0.0, 0.1, 0.2):
        assert made.add(empty, Pose2(x, 0.0, 0.0)).pose == Pose2(x, 0.0, 0.0)


def test_a_correction_beyond_belief_is_refused():
    made = mapper(most_correction_rad=0.05)
    steps = [Pose2(0.05, 0.0, 0.0)] * 5
    drive(made, steps)
    turned = scan_points(ROOM.scan(Pose2(1.25, 0.5, 0.15)), LIDAR)
    placed = made.add(turned, Pose2(0.25, 0.0, 0.0))
    assert "from where odometry says" in placed.reason
    assert angle_difference(placed.pose.yaw_rad, made.odom_in_map.yaw_rad) == pytest.approx(0.0)
