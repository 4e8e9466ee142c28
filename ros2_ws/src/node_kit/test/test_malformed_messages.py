"""Whatever a message holds, its conversion gives a usable value or a reason."""

import math
from array import array
from functools import partial

import numpy as np
import pytest
from geometry_msgs.msg import Quaternion, TransformStamped
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from nav_msgs.msg import Odometry as OdometryMessage
from rosidl_parser.definition import AbstractNestedType, AbstractString, Array, BasicType, NamespacedType
from tf2_msgs.msg import TFMessage

from node_kit import RejectedMessage, conversions
from node_kit.conversions.transform import transforms_from_message

FAMILIES = (
    "imu",
    "tracks",
    "odometry",
    "pose_sample",
    "pose_stamped",
    "occupancy_grid",
    "slip",
    "trajectory",
    "command",
    "twist",
    "scan",
    "joystick",
    "clock",
    "solver_status",
    "goal_reached",
    "bool",
    "string",
    "body_state",
    "transforms",
)
OTHERS = {
    "body_state": (OdometryMessage, conversions.body_state_from_message),
    "transforms": (TFMessage, transforms_from_message),
}
MAY_HOLD_NON_FINITE = {"ranges_m", "range_max_m", "cost", "vertical_acceleration_mps2"}
PLAUSIBLE = st.sampled_from([0.0, 1.0, 0.5])
DOUBLES = PLAUSIBLE | st.floats()
# The messages' own check of single precision refuses the very largest finite numbers.
SINGLES = PLAUSIBLE | st.floats(-(2.0**126), 2.0**126, width=32) | st.sampled_from([math.inf, -math.inf, math.nan])
INTEGERS = {
    "int8": (-128, 127),
    "uint8": (0, 255),
    "int32": (-(2**31), 2**31 - 1),
    "uint32": (0, 2**32 - 1),
    "uint64": (0, 2**64 - 1),
}

TYPE_CODES = {"double": "d", "float": "f", "int8": "b", "int32": "i"}


def random_value(kind, draw):
    """Any value that a field of this kind can hold, mixing plausible ones in."""
    if isinstance(kind, BasicType):
        if kind.typename == "boolean":
            return draw(st.booleans())
        if kind.typename in ("double", "float"):
            return draw(DOUBLES if kind.typename == "double" else SINGLES)
        low, high = INTEGERS[kind.typename]
        return draw(st.integers(max(low, 0), min(high, 100)) | st.integers(low, high))
    if isinstance(kind, AbstractString):
        return draw(st.sampled_from(["odom", "left_track", "right_track", "", "/odom"]) | st.text(max_size=5))
    if isinstance(kind, NamespacedType):
        module = __import__(".".join(kind.namespaces), fromlist=[kind.name])
        return random_message(getattr(module, kind.name), draw)
    assert isinstance(kind, AbstractNestedType)
    if isinstance(kind, Array):
        elements = np.eye(round(math.sqrt(kind.size))).ravel()
        for _ in range(draw(st.integers(0, 2))):
            elements[draw(st.integers(0, kind.size - 1))] = random_value(kind.value_type, draw)
        return elements
    values = [random_value(kind.value_type, draw) for _ in range(draw(st.integers(0, 4)))]
    if isinstance(kind.value_type, BasicType):
        return array(TYPE_CODES[kind.value_type.typename], values)
    return values


def random_message(message_type, draw):
    message = message_type()
    for name, kind in zip(message.get_fields_and_field_types(), message.SLOT_TYPES, strict=True):
        setattr(message, name, random_value(kind, draw))
    return message


def assert_usable(value, name="value"):
    if isinstance(value, float | np.ndarray):
        assert name in MAY_HOLD_NON_FINITE or np.isfinite(value).all(), name
    elif hasattr(value, "__dataclass_fields__"):
        for field in value.__dataclass_fields__:
            assert_usable(getattr(value, field), field)


@pytest.mark.parametrize("family", FAMILIES)
@settings(max_examples=100, suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large])
@given(data=st.data())
def test_any_message_gives_a_usable_value_or_a_short_reason(families, family, data):
    message_type, handler = OTHERS[family] if family in OTHERS else families[family][1::2]
    message = random_message(message_type, data.draw)
    reason, value = outcome(handler, message)
    assert reason is None or (0 < len(reason) < 100 and "\n" not in reason)
    assert_usable(value)


def outcome(handler, message):
    try:
        return None, handler(message)
    except RejectedMessage as rejection:
        return rejection.reason, None


def spoiled(families, family, *path_and_value):
    """The good message of a family with one thing changed."""
    value, _, to_message, _ = families[family]
    message = to_message(value)
    *path, last, bad = path_and_value
    target = message
    for step in path:
        target = target[step] if isinstance(step, int) else getattr(target, step)
    if isinstance(last, int):
        target[last] = bad
    else:
        setattr(target, last, bad)
    return message


@pytest.mark.parametrize(
    ("family", "change", "reason"),
    [
        ("imu", ("header", "frame_id", ""), "empty frame: header.frame_id"),
        ("imu", ("header", "stamp", "sec", -1), "negative: stamp"),
        ("imu", ("header", "stamp", "nanosec", 10**9), "nanoseconds beyond a second: stamp"),
        ("imu", ("angular_velocity", "z", math.nan), "not finite: angular_velocity.z"),
        ("imu", ("linear_acceleration", "x", math.inf), "not finite: linear_acceleration.x"),
        ("imu", ("angular_velocity_covariance", 0, -1.0), "not measured: angular_velocity"),
        ("imu", ("linear_acceleration_covariance", 0, -1.0), "not measured: linear_acceleration"),
        ("imu", ("linear_acceleration_covariance", 1, 1.0), "not symmetric: linear_acceleration_covariance"),
        ("tracks", ("name", ["left_track", "wheel"]), "joint right_track occurs 0 times"),
        ("tracks", ("name", ["left_track", "left_track"]), "joint left_track occurs 2 times"),
        ("safety_state", ("state", 9), "unknown state: 9"),
        ("tracks", ("velocity", array("d", [0.0])), "size of velocity is 1, expected 2"),
        ("tracks", ("position", 1, math.nan), "not finite: position of right_track"),
        ("odometry", ("child_frame_id", ""), "empty frame: child_frame_id"),
        ("odometry", ("pose", "pose", "orientation", "w", 5.0), "quaternion norm is not 1: orientation"),
        ("odometry", ("pose", "covariance", 0, -1.0), "negative variance: pose covariance"),
        ("odometry", ("twist", "covariance", 35, math.nan), "not finite: twist covariance"),
        ("pose_sample", ("pose", "pose", "position", "x", math.inf), "not finite: position.x"),
        ("pose_sample", ("pose", "covariance", 35, -1.0), "negative variance: pose covariance"),
        ("pose_stamped", ("pose", "orientation", "w", 5.0), "quaternion norm is not 1: orientation"),
        ("pose_stamped", ("pose", "orientation", "z", math.nan), "not finite: orientation"),
        ("pose_stamped", ("pose", "position", "y", math.nan), "not finite: position.y"),
        ("pose_stamped", ("header", "frame_id", ""), "empty frame: header.frame_id"),
        ("occupancy_grid", ("header", "frame_id", ""), "empty frame: header.frame_id"),
        ("occupancy_grid", ("info", "width", 2**31), "2147483648 x 2 cells, expected 1 to 268435456"),
        ("occupancy_grid", ("info", "height", 2**32 - 1), "3 x 4294967295 cells, expected 1 to 268435456"),
        ("occupancy_grid", ("info", "width", 0), "0 x 2 cells, expected 1 to 268435456"),
        ("occupancy_grid", ("info", "resolution", -0.05), "not positive: resolution"),
        ("occupancy_grid", ("info", "resolution", 0.0), "not positive: resolution"),
        ("occupancy_grid", ("info", "resolution", math.nan), "not finite: resolution"),
        ("occupancy_grid", ("data", array("b", [0] * 5)), "size of data is 5, expected 3 x 2"),
        ("occupancy_grid", ("data", 3, 101), "a cell is outside -1 to 100"),
        ("occupancy_grid", ("data", 3, -2), "a cell is outside -1 to 100"),
        ("occupancy_grid", ("info", "origin", "orientation", "w", 5.0), "quaternion norm is not 1: origin"),
        ("occupancy_grid", ("info", "origin", "orientation", Quaternion(x=1.0, w=0.0)), "tilted: origin"),
        ("occupancy_grid", ("info", "origin", "position", "x", math.inf), "not finite: origin.x"),
        ("slip", ("speed_variance", -1.0), "negative: speed_variance"),
        ("slip", ("yaw_rate", math.nan), "not finite: yaw_rate"),
        ("trajectory", ("x", array("d", [])), "size of x is 0, expected 3"),
        ("trajectory", ("time_from_start", array("d", [])), "size of time_from_start is 0, expected 1 to 100000"),
        ("trajectory", ("time_from_start", 1, 0.0), "times do not increase"),
        ("trajectory", ("yaw", 1, math.nan), "not finite: yaw"),
        ("command", ("twist", "linear", "x", math.nan), "not finite: linear.x"),
        ("command", ("twist", "angular", "y", -math.inf), "not finite: angular.y"),
        ("joystick", ("axes", array("f", [0.0, math.nan])), "not finite: axes"),
        ("joystick", ("axes", array("f", [3.0])), "beyond -1 to 1: axes"),
        ("joystick", ("buttons", array("i", [0] * 1000)), "more than 256 axes or buttons"),
        ("scan", ("angle_increment", 0.0), "zero: angle_increment"),
        ("scan", ("angle_min", 1e9), "more than two turns: angle_min"),
        ("scan", ("angle_max", -1e9), "more than two turns: angle_max"),
        ("scan", ("time_increment", 1e9), "a revolution of more than 60 s"),
        ("scan", ("scan_time", 61.0), "a revolution of more than 60 s"),
        ("scan", ("ranges", array("f", [1.0])), "size of ranges disagrees with the angles"),
        ("scan", ("ranges", array("f", [])), "size of ranges is 0, expected 1 to 1000000"),
        ("scan", ("range_max", math.nan), "range_max does not exceed range_min"),
        ("scan", ("scan_time", -1.0), "negative: scan_time"),
        ("solver_status", ("cost", math.nan), "not finite: cost"),
        ("solver_status", ("cpu_time", -1.0), "negative: cpu_time"),
        ("goal_reached", ("position_error", -1.0), "negative: position_error"),
    ],
)
def test_each_defect_has_its_reason(families, family, change, reason):
    with pytest.raises(RejectedMessage) as caught:
        families[family][3](spoiled(families, family, *change))
    assert caught.value.reason == reason


def test_status_of_a_failed_tick_may_have_no_cost(families):
    message = spoiled(families, "solver_status", "cost", math.nan)
    message.ok = False
    assert math.isnan(conversions.solver_status_from_message(message).cost)


def test_orientation_of_an_imu_that_has_none_is_not_read(families):
    message = spoiled(families, "imu", "orientation", "w", math.nan)
    assert conversions.imu_from_message(message).frame_id == "imu_link"
    message.orientation_covariance[0] = 0.1
    with pytest.raises(RejectedMessage, match="not finite: orientation"):
        conversions.imu_from_message(message)


def test_belt_travel_that_overflows_is_refused(families):
    message = spoiled(families, "tracks", "position", 0, 1e308)
    with pytest.raises(RejectedMessage, match="not finite: position of left_track"):
        partial(conversions.tracks_from_message, wheel_radius_m=100.0)(message)


def test_a_frame_cannot_be_its_own_parent():
    message = TFMessage(transforms=[])
    message.transforms.append(TransformStamped(child_frame_id="odom"))
    message.transforms[0].header.frame_id = "odom"
    with pytest.raises(RejectedMessage, match="own parent"):
        transforms_from_message(message)
