import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tracked_localization.mapping.log_odds_grid import LogOddsGrid, LogOddsSettings
from tracked_localization.matching.line_world import CORRIDOR, ROOM
from tracked_localization.matching.scan_matcher import MatchSettings, match_scan
from tracked_localization.matching.wall_field import WallField
from tracked_types import OccupancyMap, Pose2, angle_difference
from tracked_types.scan_points import scan_points

LIDAR, SETTINGS = Pose2(0.0, 0.0, 0.0), MatchSettings()


def route(steps=60):
    """Poses of a drive through the room."""
    poses = [Pose2(-3.0, 0.5, 0.0)]
    for step in range(steps):
        poses.append(poses[-1].compose(Pose2(0.07, 0.0, 0.06 * float(np.sin(step / 9.0)))))
    return poses


def field_of(world, poses):
    generator, grid = np.random.default_rng(1), LogOddsGrid(LogOddsSettings(), "map")
    for pose in poses:
        grid.add(scan_points(world.scan(pose, generator), LIDAR), pose)
    return WallField(grid.as_map())


ROOM_FIELD = field_of(ROOM, route())
CORRIDOR_FIELD = field_of(CORRIDOR, [Pose2(x, 0.0, 0.0) for x in np.arange(-3.0, 3.0, 0.1)])


@settings(max_examples=40, deadline=None)
@given(
    step=st.integers(0, 60),
    seed=st.integers(0, 10**6),
    offset=st.tuples(st.floats(-0.15, 0.15), st.floats(-0.15, 0.15), st.floats(-0.1, 0.1)),
)
def test_a_scan_finds_its_place_from_nearby(step, seed, offset):
    truth = route()[step]
    scan = ROOM.scan(truth, np.random.default_rng(seed))
    match = match_scan(ROOM_FIELD, scan_points(scan, LIDAR).hits, truth.compose(Pose2(*offset)), SETTINGS)
    assert match.converged and match.seen == 3 and match.agreement > 0.8
    assert np.hypot(match.pose.x_m - truth.x_m, match.pose.y_m - truth.y_m) < 0.015
    assert abs(angle_difference(match.pose.yaw_rad, truth.yaw_rad)) < 0.006


def test_the_length_of_a_corridor_stays_as_guessed():
    truth, guess = Pose2(0.4, 0.2, 0.05), Pose2(0.9, 0.25, 0.1)
    points = scan_points(CORRIDOR.scan(truth, np.random.default_rng(0)), LIDAR).hits
    match = match_scan(CORRIDOR_FIELD, points, guess, SETTINGS)
    assert match.seen == 2
    assert match.pose.x_m == pytest.approx(guess.x_m, abs=0.01)
    assert match.pose.y_m == pytest.approx(truth.y_m, abs=0.02)
    assert match.pose.yaw_rad == pytest.approx(truth.yaw_rad, abs=0.01)
    assert match.information[0, 0] < 1e-3 * match.information[1, 1]


def test_a_scan_of_another_place_agrees_with_nothing():
    points = scan_points(CORRIDOR.scan(Pose2(0.0, 0.0, 0.0)), LIDAR).hits
    assert match_scan(ROOM_FIELD, points, Pose2(0.0, 1.0, 0.8), SETTINGS).agreement < 0.5


def test_too_few_points_say_nothing():
    guess = Pose2(0.0, 0.0, 0.0)
    for points in (np.zeros((0, 2)), np.array([[1.0, 0.0]]), np.full((50, 2), 1e6)):
        match = match_scan(ROOM_FIELD, points, guess, SETTINGS)
        assert match.pose == guess and match.seen == 0 and not match.information.any()


@pytest.mark.parametrize("points", [np.array([[np.nan, 0.0]]), np.array([[np.inf, 0.0]])])
def test_points_that_are_not_finite_are_refused(points):
    with pytest.raises(ValueError, match="finite"):
        match_scan(ROOM_FIELD, points, Pose2(0.0, 0.0, 0.0), SETTINGS)


def test_a_map_without_walls_is_refused():
    with pytest.raises(ValueError, match="occupied"):
        WallField(OccupancyMap("map", 0.05, Pose2(0.0, 0.0, 0.0), np.zeros((5, 5), np.int8)))


def test_a_turned_map_gives_the_same_walls():
    occupancy = np.zeros((40, 40), np.int8)
    occupancy[20, :] = 100
    turned = WallField(OccupancyMap("map", 0.1, Pose2(3.0, 0.0, np.pi / 2), occupancy))
    walls = turned.at(np.array([[1.2, 2.0], [0.7, 2.0]]))  # the wall runs along x = 3 - 2.05
    assert walls.offset_m * walls.normal[:, 0] == pytest.approx([0.25, -0.25])
    assert abs(walls.normal[:, 1]).max() < 1e-9


def test_the_two_faces_of_a_thin_wall_are_told_apart():
    occupancy = np.zeros((40, 40), np.int8)
    occupancy[[18, 20], 5:35] = 100  # faces of a wall of 15 cm, seen from both sides
    occupancy[19, 5:35] = -1
    field = WallField(OccupancyMap("map", 0.05, Pose2(0.0, 0.0, 0.0), occupancy))
    walls = field.at(np.array([[1.0, 0.925], [1.0, 1.025]]))
    np.testing.assert_allclose(walls.offset_m, 0.0, atol=1e-9)
    np.testing.assert_allclose(np.abs(walls.normal[:, 1]), 1.0)
