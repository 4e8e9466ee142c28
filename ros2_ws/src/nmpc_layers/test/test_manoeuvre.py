import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from nmpc_layers.manoeuvre import ManoeuvreRates, manoeuvre
from tracked_types import Pose2, angle_difference

RATES = ManoeuvreRates(speed_mps=0.15, yaw_rate_radps=0.5, acceleration_mps2=0.5, yaw_acceleration_radps2=2.0)
poses = st.builds(Pose2, st.floats(-2.0, 2.0), st.floats(-2.0, 2.0), st.floats(-math.pi, math.pi))
near = st.builds(Pose2, st.floats(-0.1, 0.1), st.floats(-0.1, 0.1), st.floats(-0.5, 0.5))


@settings(max_examples=150, derandomize=True)
@given(start=poses, goal=poses)
def test_ends_at_the_goal_at_rest_within_the_rates(start, goal):
    way = manoeuvre(start, goal, RATES, 0, "odom")
    assert way.states[0, :2] == pytest.approx([start.x_m, start.y_m], abs=1e-9)
    assert math.hypot(way.states[-1, 0] - goal.x_m, way.states[-1, 1] - goal.y_m) < 0.0035
    assert abs(angle_difference(float(way.states[-1, 2]), goal.yaw_rad)) < 0.0025
    assert np.all(way.inputs[[0, -1]] == 0.0)
    assert np.abs(way.inputs[:, 0]).max() <= RATES.speed_mps + 1e-9
    assert np.abs(way.inputs[:, 1]).max() <= RATES.yaw_rate_radps + 1e-9


@settings(max_examples=100, derandomize=True)
@given(start=poses, goal=poses)
def test_robot_never_moves_sideways(start, goal):
    way = manoeuvre(start, goal, RATES, 0, "odom")
    steps = np.diff(way.states[:, :2], axis=0)
    headings = way.states[1:, 2]
    assert np.abs(-np.sin(headings) * steps[:, 0] + np.cos(headings) * steps[:, 1]).max(initial=0.0) < 1e-9


@settings(max_examples=100, derandomize=True)
@given(start=near)
def test_small_offset_needs_small_room(start):
    way = manoeuvre(start, Pose2(0.0, 0.0, 0.0), RATES, 0, "odom")
    assert np.abs(way.states[:, :2]).max() < 0.3


def test_no_offset_is_a_single_resting_point():
    way = manoeuvre(Pose2(1.0, 2.0, 3.0), Pose2(1.0, 2.0, 3.0), RATES, 5, "odom")
    assert way.states.shape == (1, 3) and way.stamp_ns == 5


def test_short_of_the_goal_drives_straight_on():
    way = manoeuvre(Pose2(-0.05, 0.0, 0.0), Pose2(0.0, 0.0, 0.0), RATES, 0, "odom")
    assert np.all(way.inputs[:, 1] == 0.0) and np.all(way.inputs[:, 0] >= 0.0)


def test_beyond_the_goal_drives_straight_back():
    way = manoeuvre(Pose2(1.0, 0.0, 0.0), Pose2(0.0, 0.0, 0.0), RATES, 0, "odom")
    assert np.all(way.inputs[:, 1] == 0.0) and np.all(way.inputs[:, 0] <= 0.0)
