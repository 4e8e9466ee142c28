import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tracked_description import Footprint, load_robot

FOOTPRINT = Footprint(0.4, 0.3, 0.2)


def test_the_robot_covers_its_belts():
    footprint = Footprint.from_robot(load_robot())
    assert footprint.front_m == pytest.approx(0.34) and footprint.half_width_m == pytest.approx(0.215)


@given(st.floats(-2, 2), st.floats(-2, 2))
def test_distance_is_that_to_the_nearest_edge_and_negative_inside(x, y):
    distance = float(FOOTPRINT.distance(np.array([x, y])))
    nearest = np.array([np.clip(x, -0.3, 0.4), np.clip(y, -0.2, 0.2)])
    if (nearest == (x, y)).all():
        assert distance == pytest.approx(-min(0.4 - x, x + 0.3, 0.2 - abs(y)), abs=1e-12)
    else:
        assert distance == pytest.approx(np.hypot(*(nearest - (x, y))))


def test_a_grown_footprint_has_so_much_more_room_everywhere():
    assert FOOTPRINT.grown(0.1).corners == pytest.approx(np.sign(FOOTPRINT.corners) * 0.1 + FOOTPRINT.corners)
