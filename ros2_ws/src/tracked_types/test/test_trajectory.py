import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tracked_types import Trajectory


def straight_line() -> Trajectory:
    times = np.array([0.0, 1.0, 2.0])
    states = np.array([[0.0, 0.0, 3.1], [1.0, 0.0, -3.1], [2.0, 0.0, -3.0]])
    return Trajectory(10**9, "odom", times, states, np.array([[1.0, 0.0]] * 3))


def test_heading_interpolates_across_the_wrap():
    states, _ = straight_line().at(10**9, np.array([0.5]))
    assert abs(states[0, 2]) == pytest.approx(math.pi, abs=1e-9)


def test_poses_hold_beyond_both_ends():
    states, _ = straight_line().at(10**9, np.array([-5.0, 50.0]))
    assert states[:, 0] == pytest.approx([0.0, 2.0])


def test_single_point_is_constant():
    point = Trajectory(0, "odom", np.array([0.0]), np.array([[1.0, 2.0, 0.5]]), np.zeros((1, 2)))
    states, inputs = point.at(7, np.array([0.0, 3.0]))
    assert states.tolist() == [[1.0, 2.0, 0.5]] * 2 and inputs.shape == (2, 2)


@pytest.mark.parametrize("times", [[], [0.0, 0.0, 1.0], [0.0, 1.0, 0.5]])
def test_refuses_times_that_do_not_increase(times):
    count = len(times)
    with pytest.raises(ValueError):
        Trajectory(0, "odom", np.array(times), np.zeros((count, 3)), np.zeros((count, 2)))


def test_refuses_shapes_that_disagree():
    with pytest.raises(ValueError, match=r"states \(2, 3\)"):
        Trajectory(0, "odom", np.array([0.0, 1.0]), np.zeros((3, 3)), np.zeros((2, 2)))


@given(st.floats(-10.0, 10.0), st.integers(0, 2 * 10**18))
def test_result_depends_on_the_instant_only(offset, stamp):
    first, _ = Trajectory(
        stamp, "odom", np.array([0.0, 4.0]), np.array([[0.0, 0.0, 0.0], [4.0, 1.0, 1.0]]), np.zeros((2, 2))
    ).at(stamp, np.array([offset]))
    assert 0.0 <= first[0, 0] <= 4.0
