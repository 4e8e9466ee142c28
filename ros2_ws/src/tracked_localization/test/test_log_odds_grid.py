import numpy as np
import pytest

from tracked_localization.mapping.log_odds_grid import LogOddsGrid, LogOddsSettings, MapTooLargeError
from tracked_localization.matching.line_world import ROOM, LineWorld
from tracked_types import Pose2
from tracked_types.scan_points import ScanPoints, scan_points

LIDAR = Pose2(0.0, 0.0, 0.0)
NOWHERE = np.zeros((0, 2))


def route(steps=60):
    """Poses of a drive through the room."""
    poses = [Pose2(-3.0, 0.5, 0.0)]
    for step in range(steps):
        poses.append(poses[-1].compose(Pose2(0.07, 0.0, 0.06 * float(np.sin(step / 9.0)))))
    return poses


def mapped(poses, seed=0, world=ROOM):
    generator, grid = np.random.default_rng(seed), LogOddsGrid(LogOddsSettings(), "map")
    for pose in poses:
        grid.add(scan_points(world.scan(pose, generator), LIDAR), pose)
    return grid


def test_every_occupied_cell_lies_on_a_wall_and_the_room_is_free():
    found = mapped(route()).as_map()
    occupied = found.centres_of(np.argwhere(found.occupancy > 65))
    assert len(occupied) > 500
    assert ROOM.distances(occupied).max() < 0.05
    inside = found.cells_of(np.array([[0.0, 0.0], [2.0, 2.0], [-3.0, 3.0]]))
    assert (found.occupancy[inside[:, 0], inside[:, 1]] < 5).all()
    beyond = found.cells_of(np.array([[5.5, 0.0], [0.0, -3.5]]))
    assert (found.occupancy[beyond[:, 0], beyond[:, 1]] == -1).all()


def test_what_has_moved_away_is_forgotten():
    person = np.array([[[0.0, 1.0], [0.3, 1.0]]])
    grid = mapped([Pose2(0.0, 0.0, 0.0)] * 20, world=LineWorld(np.concatenate([ROOM.walls, person])))
    cell = lambda room: room.occupancy[tuple(room.cells_of(np.array([[0.15, 1.0]]))[0])]  # noqa: E731
    assert cell(grid.as_map()) > 90
    for _ in range(20):
        grid.add(scan_points(ROOM.scan(Pose2(0.0, 0.0, 0.0)), LIDAR), Pose2(0.0, 0.0, 0.0))
    assert cell(grid.as_map()) < 10


def test_a_map_grows_in_every_direction_and_keeps_what_it_had():
    grid = mapped([Pose2(0.0, 0.0, 0.0)])
    before = grid.as_map()
    far = ScanPoints(0, np.array([[30.0, 0.0]]), NOWHERE, (0.0, 0.0))
    for yaw in (0.0, 1.6, 3.1, -1.6):
        grid.add(far, Pose2(0.0, 0.0, yaw))
    after = grid.as_map()
    known = np.argwhere(before.occupancy > 65)
    rows, columns = after.cells_of(before.centres_of(known)).T
    assert after.occupancy.size > before.occupancy.size
    assert (after.occupancy[rows, columns] > 65).mean() > 0.99


def test_a_scan_that_saw_nothing_at_all_changes_nothing():
    grid = mapped([Pose2(0.0, 0.0, 0.0)])
    before = grid.as_map()
    grid.add(ScanPoints(0, NOWHERE, NOWHERE, (0.0, 0.0)), Pose2(0.0, 0.0, 0.0))
    assert np.array_equal(grid.as_map().occupancy, before.occupancy)


@pytest.mark.parametrize("place", [(1e7, 0.0), (np.nan, 0.0), (5e4, 5e4)])
def test_a_point_out_of_this_world_is_refused_and_the_map_stays(place):
    grid = mapped([Pose2(0.0, 0.0, 0.0)])
    before = grid.as_map()
    with pytest.raises(MapTooLargeError):
        grid.add(ScanPoints(0, np.array([place]), NOWHERE, (0.0, 0.0)), Pose2(0.0, 0.0, 0.0))
    assert np.array_equal(grid.as_map().occupancy, before.occupancy)
