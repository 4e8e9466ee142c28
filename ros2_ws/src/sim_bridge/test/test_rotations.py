import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sim_bridge.sensors.rotations import (
    roll_pitch_yaw_of,
    rotation_from_roll_pitch_yaw,
    rotation_from_vector,
    vector_of_rotation,
)

components = st.floats(-1.7, 1.7)


def test_yaw_turns_x_towards_y():
    turned = rotation_from_roll_pitch_yaw(0.0, 0.0, math.pi / 2) @ np.array([1.0, 0.0, 0.0])
    np.testing.assert_allclose(turned, [0.0, 1.0, 0.0], atol=1e-15)


@given(st.floats(-3.1, 3.1), st.floats(-1.5, 1.5), st.floats(-3.1, 3.1))
def test_angles_round_trip(roll, pitch, yaw):
    rotation = rotation_from_roll_pitch_yaw(roll, pitch, yaw)
    np.testing.assert_allclose(roll_pitch_yaw_of(rotation), [roll, pitch, yaw], atol=1e-9)


@given(components, components, components)
def test_rotation_vector_round_trips_and_keeps_lengths(x, y, z):
    rotation = rotation_from_vector(np.array([x, y, z]))
    np.testing.assert_allclose(rotation @ rotation.T, np.eye(3), atol=1e-12)
    np.testing.assert_allclose(vector_of_rotation(rotation), [x, y, z], atol=1e-7)


@pytest.mark.parametrize("angle", [0.0, 1e-12, 1e-7, 1e-3])
def test_small_turns_lose_nothing(angle):
    vector = np.array([0.0, 0.0, angle])
    np.testing.assert_allclose(vector_of_rotation(rotation_from_vector(vector)), vector, rtol=1e-9, atol=1e-20)
