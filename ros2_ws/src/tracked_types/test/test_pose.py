import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tracked_types import Pose2, angle_difference, wrap_angle

COORDINATES = st.floats(-1e3, 1e3)
POSES = st.builds(Pose2, COORDINATES, COORDINATES, st.floats(-math.pi, math.pi))


@given(POSES)
def test_composing_with_the_inverse_is_the_identity(pose):
    identity = pose.compose(pose.inverse())
    assert identity.x_m == pytest.approx(0.0, abs=1e-9)
    assert identity.y_m == pytest.approx(0.0, abs=1e-9)
    assert math.cos(identity.yaw_rad) == pytest.approx(1.0)


@given(st.floats(-1e6, 1e6))
def test_wrapping_keeps_the_direction(angle):
    wrapped = wrap_angle(angle)
    assert -math.pi < wrapped <= math.pi
    assert math.cos(wrapped) == pytest.approx(math.cos(angle), abs=1e-6)


def test_minus_pi_wraps_to_plus_pi():
    assert wrap_angle(-math.pi) == math.pi


def test_difference_takes_the_shorter_way():
    assert angle_difference(-3.0, 3.0) == pytest.approx(2.0 * math.pi - 6.0)
