import numpy as np
import pytest

from tracked_types import UNKNOWN, OccupancyMap, Pose2


def test_the_known_part_keeps_its_cells_where_they_are():
    occupancy = np.full((6, 8), UNKNOWN, np.int8)
    occupancy[2, 3], occupancy[4, 5] = 100, 0
    whole = OccupancyMap("map", 0.5, Pose2(1.0, 2.0, 0.7), occupancy)
    part = whole.known_part()
    assert part.occupancy.tolist() == [[100, -1, -1], [-1, -1, -1], [-1, -1, 0]]
    assert part.centres_of(np.array([[0, 0], [2, 2]])) == pytest.approx(whole.centres_of(np.array([[2, 3], [4, 5]])))


def test_a_map_of_which_nothing_is_known_has_no_known_part():
    whole = OccupancyMap("map", 0.5, Pose2(0.0, 0.0, 0.0), np.full((3, 4), UNKNOWN, np.int8))
    assert whole.known_part() is whole
