"""Transforms over time: interpolation, chains, gaps and jumps of the clock."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from node_kit import RigidTransform, TransformBuffer, TransformError
from node_kit.rotations import (
    multiply,
    quaternion_from_roll_pitch_yaw,
    quaternion_from_yaw,
    roll_pitch_yaw_from_quaternion,
    rotate,
    slerp,
    yaw_from_quaternion,
)
from tracked_types import NANOSECONDS_PER_SECOND

SECOND = NANOSECONDS_PER_SECOND
ANGLES = st.floats(-3.1, 3.1)
POSES = st.builds(
    RigidTransform.from_euler,
    *[st.floats(-10.0, 10.0)] * 3,
    ANGLES,
    st.floats(-1.5, 1.5),
    ANGLES,
)


def at(x, yaw=0.0):
    return RigidTransform.from_euler(x, 0.0, 0.0, 0.0, 0.0, yaw)


def assert_same_transform(first, second):
    np.testing.assert_allclose(first.translation_m, second.translation_m, atol=1e-9)
    assert abs(np.dot(first.quaternion, second.quaternion)) == pytest.approx(1.0)


@given(ANGLES, st.floats(-1.5, 1.5), ANGLES)
def test_euler_angles_survive_the_quaternion(roll, pitch, yaw):
    back = roll_pitch_yaw_from_quaternion(*quaternion_from_roll_pitch_yaw(roll, pitch, yaw))
    np.testing.assert_allclose(back, (roll, pitch, yaw), atol=1e-6)


@pytest.mark.parametrize("pitch", [math.pi / 2, -math.pi / 2])
@given(roll=ANGLES, yaw=ANGLES)
def test_gimbal_lock_gives_angles_of_the_same_rotation(pitch, roll, yaw):
    quaternion = quaternion_from_roll_pitch_yaw(roll, pitch, yaw)
    again = quaternion_from_roll_pitch_yaw(*roll_pitch_yaw_from_quaternion(*quaternion))
    assert abs(np.dot(quaternion, again)) == pytest.approx(1.0, abs=1e-6)


@given(ANGLES)
def test_yaw_survives_the_quaternion(yaw):
    assert yaw_from_quaternion(*quaternion_from_yaw(yaw)) == pytest.approx(yaw)


@given(POSES, POSES)
def test_rotating_twice_is_rotating_by_the_product(first, second):
    vector = (1.0, -2.0, 0.5)
    twice = rotate(first.quaternion, rotate(second.quaternion, vector))
    np.testing.assert_allclose(rotate(multiply(first.quaternion, second.quaternion), vector), twice, atol=1e-9)


@given(POSES)
def test_inverse_undoes(pose):
    assert_same_transform(pose.compose(pose.inverse()), RigidTransform.identity())


@given(ANGLES, ANGLES, st.floats(0.0, 1.0))
def test_slerp_turns_the_short_way_at_constant_rate(start, end, weight):
    turn = math.remainder(end - start, 2.0 * math.pi)
    if abs(abs(turn) - math.pi) < 1e-3:  # both ways are equally short
        return
    yaw = yaw_from_quaternion(*slerp(quaternion_from_yaw(start), quaternion_from_yaw(end), weight))
    assert math.remainder(yaw - start - weight * turn, 2.0 * math.pi) == pytest.approx(0.0, abs=1e-5)


def buffer_with_motion():
    buffer = TransformBuffer()
    buffer.add("odom", "base", at(0.0), 0)
    buffer.add("odom", "base", at(1.0, math.pi / 2), SECOND)
    buffer.add_static("base", "laser", at(0.2))
    return buffer


def test_lookup_interpolates_and_chains():
    pose = buffer_with_motion().lookup("odom", "laser", SECOND // 2)
    x, y, _ = pose.translation_m
    assert (x, y) == pytest.approx((0.5 + 0.2 * math.cos(math.pi / 4), 0.2 * math.sin(math.pi / 4)))
    assert pose.roll_pitch_yaw_rad[2] == pytest.approx(math.pi / 4)


def test_lookup_backwards_is_the_inverse():
    buffer = buffer_with_motion()
    forward, backward = buffer.lookup("odom", "laser", 3), buffer.lookup("laser", "odom", 3)
    assert_same_transform(forward.compose(backward), RigidTransform.identity())


def test_lookup_between_siblings_goes_over_the_common_parent():
    buffer = buffer_with_motion()
    buffer.add_static("base", "camera", at(0.5))
    assert buffer.lookup("laser", "camera").translation_m[0] == pytest.approx(0.3)


def test_newest_common_instant_is_that_of_the_slowest_edge():
    buffer = buffer_with_motion()
    buffer.add("map", "odom", at(10.0), SECOND // 2)
    assert buffer.lookup("map", "base").translation_m[0] == pytest.approx(10.5)


def test_a_frame_in_itself_is_the_identity():
    assert TransformBuffer().lookup("anything", "anything") == RigidTransform.identity()


@pytest.mark.parametrize(
    ("target", "source", "stamp_ns", "reason"),
    [
        ("odom", "gripper", None, "gripper unknown"),
        ("odom", "lonely", None, "not connected"),
        ("odom", "base", -SECOND, "1 s before the oldest"),
        ("odom", "base", 2 * SECOND, "1 s after the newest"),
        ("odom", "slow", 2 * SECOND, "nothing known for 5 s"),
    ],
)
def test_lookup_without_data_says_why(target, source, stamp_ns, reason):
    buffer = buffer_with_motion()
    buffer.add_static("elsewhere", "lonely", at(0.0))
    buffer.add("odom", "slow", at(0.0), 0)
    buffer.add("odom", "slow", at(1.0), 5 * SECOND)
    with pytest.raises(TransformError, match=reason):
        buffer.lookup(target, source, stamp_ns)


def test_late_message_is_sorted_in():
    buffer = TransformBuffer()
    for x, stamp_ns in ((0.0, 0), (2.0, SECOND), (5.0, SECOND // 2)):
        buffer.add("odom", "base", at(x), stamp_ns)
    assert buffer.lookup("odom", "base", SECOND // 2).translation_m[0] == 5.0
    assert buffer.lookup("odom", "base", SECOND // 4).translation_m[0] == 2.5


def test_clock_that_jumps_back_starts_anew():
    buffer = TransformBuffer()
    buffer.add("odom", "base", at(9.0), 100 * SECOND)
    buffer.add("odom", "base", at(1.0), 3 * SECOND)
    assert buffer.lookup("odom", "base").translation_m[0] == 1.0
    with pytest.raises(TransformError, match="after the newest"):
        buffer.lookup("odom", "base", 100 * SECOND)


def test_forgotten_motion_is_missing_while_static_frames_stay():
    buffer = buffer_with_motion()
    buffer.clear_moving()
    with pytest.raises(TransformError, match="no data yet for base in odom"):
        buffer.lookup("odom", "laser")
    with pytest.raises(TransformError, match="no data yet"):
        buffer.lookup("odom", "laser", 0)
    assert buffer.lookup("base", "laser").translation_m[0] == 0.2


def test_old_transforms_are_dropped():
    buffer = TransformBuffer(history_s=1.0)
    for index in range(1000):
        buffer.add("odom", "base", at(index), index * SECOND // 100)
    with pytest.raises(TransformError, match="before the oldest"):
        buffer.lookup("odom", "base", 8 * SECOND)
    assert buffer.lookup("odom", "base", 9 * SECOND).translation_m[0] == 900.0


def test_frame_with_a_new_parent_leaves_the_old_one():
    buffer = buffer_with_motion()
    buffer.add("map", "base", at(7.0), 0)
    assert buffer.lookup("map", "base").translation_m[0] == 7.0
    with pytest.raises(TransformError):
        buffer.lookup("odom", "base")


def test_moving_frame_can_become_static_and_back():
    buffer = buffer_with_motion()
    buffer.add_static("odom", "base", at(3.0))
    assert buffer.lookup("odom", "base", 77 * SECOND).translation_m[0] == 3.0
    buffer.add("odom", "base", at(4.0), SECOND)
    assert buffer.lookup("odom", "base").translation_m[0] == 4.0


def test_loops_are_refused():
    buffer = TransformBuffer()
    with pytest.raises(TransformError, match="its own parent"):
        buffer.add("base", "base", at(0.0), 0)
    buffer.add("a", "b", at(0.0), 0)
    buffer.add("b", "a", at(0.0), 0)
    with pytest.raises(TransformError, match="loop"):
        buffer.lookup("a", "b")
