"""Values survive the way into a message and back; messages survive serialisation."""

import math
from dataclasses import replace
from enum import Enum

import numpy as np
import pytest
from geometry_msgs.msg import AccelStamped, TwistStamped
from nav_msgs.msg import Odometry as OdometryMessage
from rclpy.serialization import deserialize_message, serialize_message

from node_kit import conversions
from tracked_types import (
    BodyState,
    Mover,
    TrackSample,
    Twist2,
    VelocityCommand,
)

STAMP_NS = 12_345_678_901
RADIUS_M = 0.04
FAMILIES = (
    "imu",
    "tracks",
    "odometry",
    "pose_sample",
    "pose_stamped",
    "occupancy_grid",
    "slip",
    "traction",
    "trajectory",
    "command",
    "twist",
    "scan",
    "joystick",
    "clock",
    "safety_state",
    "solver_status",
    "goal_reached",
    "bool",
    "string",
)
BODY = BodyState(
    STAMP_NS,
    np.array([1.0, 2.0, 0.1]),
    np.array([0.1, -0.2, 2.5]),
    np.array([0.3, 0.01, -0.02]),
    np.array([0.0, 0.1, 0.5]),
    1.5,
)


def assert_same(actual, expected):
    if not hasattr(expected, "__dataclass_fields__"):
        np.testing.assert_allclose(actual, expected, rtol=1e-6) if not isinstance(expected, str) else None
        assert type(actual) is type(expected)
        return
    assert type(actual) is type(expected)
    for name in expected.__dataclass_fields__:
        value, wanted = getattr(actual, name), getattr(expected, name)
        if isinstance(wanted, str | bool | int | Enum):
            assert value == wanted, name
        elif hasattr(wanted, "__dataclass_fields__"):
            assert_same(value, wanted)
        else:
            np.testing.assert_allclose(value, wanted, rtol=1e-6, atol=1e-12, err_msg=name)


@pytest.mark.parametrize("family", FAMILIES)
def test_value_survives_message_and_wire(family, families):
    value, message_type, to_message, from_message = families[family]
    wired = deserialize_message(serialize_message(to_message(value)), message_type)
    assert_same(from_message(wired), value)


@pytest.mark.parametrize("family", FAMILIES)
def test_overwritten_message_equals_a_new_one(family, families):
    value, message_type, to_message, _ = families[family]
    reused = message_type()
    assert to_message(value, into=reused) is reused
    to_message(value, into=reused)
    assert repr(reused) == repr(to_message(value))


def test_body_state_keeps_all_but_the_acceleration():
    message = conversions.body_state_to_message(BODY, frame_id="world", child_frame_id="base_footprint")
    wired = deserialize_message(serialize_message(message), OdometryMessage)
    state = conversions.body_state_from_message(wired)
    np.testing.assert_allclose(state.roll_pitch_yaw_rad, BODY.roll_pitch_yaw_rad)
    np.testing.assert_allclose(state.position_m, BODY.position_m)
    np.testing.assert_allclose(state.velocity_mps, BODY.velocity_mps)
    np.testing.assert_allclose(state.angular_velocity_radps, BODY.angular_velocity_radps)
    assert math.isnan(state.vertical_acceleration_mps2)


def test_vertical_acceleration_travels_alone():
    message = conversions.vertical_acceleration_to_message(BODY, frame_id="base_footprint")
    wired = deserialize_message(serialize_message(message), AccelStamped)
    assert conversions.vertical_acceleration_from_message(wired) == (STAMP_NS, 1.5)


def test_tracks_message_carries_suspension_joints_after_the_tracks():
    message = conversions.tracks_to_message(
        TrackSample(STAMP_NS, 0.4, 0.0, 0.0, 0.0),
        [0.01, -0.02],
        wheel_radius_m=RADIUS_M,
        suspension_joints=["front", "rear"],
    )
    assert message.name == ["left_track", "right_track", "front", "rear"]
    assert list(message.position) == pytest.approx([10.0, 0.0, 0.01, -0.02])
    assert conversions.tracks_from_message(message, wheel_radius_m=RADIUS_M).left_travel_m == pytest.approx(0.4)


def test_tracks_message_refuses_travels_without_joints():
    with pytest.raises(ValueError, match="2 travels for 0"):
        conversions.tracks_to_message(TrackSample(STAMP_NS, 0.0, 0.0, 0.0, 0.0), [0.0, 0.0], wheel_radius_m=RADIUS_M)


def test_numpy_scalars_reach_the_wire_unharmed():
    command = VelocityCommand(np.int64(STAMP_NS), Twist2(np.float32(0.5), np.float64(-1.0)))
    wired = deserialize_message(serialize_message(conversions.command_to_message(command)), TwistStamped)
    assert (wired.twist.linear.x, wired.twist.angular.z) == (0.5, -1.0)


def test_every_family_is_tested(families):
    assert set(families) == set(FAMILIES)


def test_a_driver_may_leave_belt_speeds_out(families):
    sample, _, to_message, from_message = families["tracks"]
    without = replace(sample, left_speed_mps=None, right_speed_mps=None)
    message = to_message(without)
    assert not len(message.velocity)
    assert from_message(message) == without


def test_viewers_get_paths_and_movers_with_their_course():
    path = conversions.path_to_message(np.array([[1.0, 2.0, 0.0], [2.0, 2.0, math.pi / 2.0]]), 5, "map")
    assert path.header.frame_id == "map" and len(path.poses) == 2
    assert path.poses[1].pose.orientation.z == pytest.approx(math.sin(math.pi / 4.0))
    mover = Mover(7, 5, "map", np.array([1.0, 2.0]), np.array([0.5, 0.0]), np.eye(4), 0.25)
    disc, course = conversions.movers_to_message([mover]).markers
    assert (disc.id, disc.ns, disc.scale.x) == (7, "mover", 0.5)
    assert (course.points[1].x, course.points[1].y) == (1.5, 2.0)
    assert conversions.movers_to_message([]).markers == []
