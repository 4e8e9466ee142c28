import numpy as np
import pytest

from tracked_localization.localisation.global_search import SearchSettings, find_on_map
from tracked_localization.mapping.log_odds_grid import LogOddsGrid, LogOddsSettings
from tracked_localization.matching.line_world import ROOM, LineWorld
from tracked_localization.matching.scan_matcher import MatchSettings
from tracked_localization.matching.wall_field import WallField
from tracked_types import OccupancyMap, Pose2, angle_difference
from tracked_types.scan_points import scan_points

LIDAR = Pose2(0.0, 0.0, 0.0)
SQUARE = LineWorld(
    np.array(
        [[[-2.0, -2.0], [2.0, -2.0]], [[2.0, -2.0], [2.0, 2.0]], [[2.0, 2.0], [-2.0, 2.0]], [[-2.0, 2.0], [-2.0, -2.0]]]
    )
)


def mapped(world, places):
    grid = LogOddsGrid(LogOddsSettings(), "map")
    for x, y in places:
        for _ in range(4):
            grid.add(scan_points(world.scan(Pose2(x, y, 0.0)), LIDAR), Pose2(x, y, 0.0))
    return grid.as_map()


ROOM_MAP = mapped(ROOM, [(-3.0, 0.0), (0.0, 1.0), (0.0, -2.0), (3.0, 2.0), (4.0, -2.0)])


def search(room, points):
    return find_on_map(room, WallField(room), points, SearchSettings(), MatchSettings())


@pytest.mark.parametrize("seed", range(6))
def test_a_robot_anywhere_in_the_room_is_found(seed):
    generator = np.random.default_rng(seed)
    truth = Pose2(
        float(generator.uniform(-3.5, 2.5)), float(generator.uniform(0.0, 3.5)), float(generator.uniform(-3, 3))
    )
    found = search(ROOM_MAP, scan_points(ROOM.scan(truth, generator), LIDAR))
    assert len(found) == 1
    assert np.hypot(found[0].pose.x_m - truth.x_m, found[0].pose.y_m - truth.y_m) < 0.03
    assert abs(angle_difference(found[0].pose.yaw_rad, truth.yaw_rad)) < 0.02


def test_a_room_that_looks_alike_from_four_sides_is_ambiguous():
    found = search(mapped(SQUARE, [(0.0, 0.0), (1.0, 1.0)]), scan_points(SQUARE.scan(Pose2(1.0, 0.3, 0.2)), LIDAR))
    assert len(found) == 4


def test_a_scan_of_hardly_anything_finds_nothing():
    assert search(ROOM_MAP, scan_points(LineWorld(ROOM.walls[4:5]).scan(LIDAR), LIDAR)) == ()


def test_a_map_without_a_free_cell_is_refused():
    walls = OccupancyMap("map", 0.05, LIDAR, np.full((9, 9), 100, np.int8))
    with pytest.raises(ValueError, match="free"):
        search(walls, scan_points(ROOM.scan(LIDAR), LIDAR))
