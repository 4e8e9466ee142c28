"""nav_msgs/Odometry and geometry_msgs/AccelStamped of a rigid body in space, as truth sources send them."""

import math

import numpy as np
from geometry_msgs.msg import AccelStamped
from nav_msgs.msg import Odometry as OdometryMessage

from node_kit.conversions.checks import require_finite, require_frame
from node_kit.conversions.geometry import fill_quaternion, fill_vector, quaternion_from_message, vector_from_message
from node_kit.conversions.headers import fill_header, header_from_message
from node_kit.rotations import quaternion_from_roll_pitch_yaw, roll_pitch_yaw_from_quaternion
from tracked_types import BodyState


def body_state_from_message(message: OdometryMessage) -> BodyState:
    """State of the body; the message has no acceleration, so that is NaN.

    Raises
    ------
    RejectedMessage: stamp, a frame, a number or the quaternion cannot be used.
    """
    stamp_ns, _ = header_from_message(message.header)
    require_frame("child_frame_id", message.child_frame_id)
    pose, twist = message.pose.pose, message.twist.twist
    return BodyState(
        stamp_ns,
        np.array(vector_from_message("position", pose.position)),
        np.array(roll_pitch_yaw_from_quaternion(*quaternion_from_message("orientation", pose.orientation))),
        np.array(vector_from_message("linear", twist.linear)),
        np.array(vector_from_message("angular", twist.angular)),
        math.nan,
    )


def body_state_to_message(
    state: BodyState, into: OdometryMessage | None = None, *, frame_id: str, child_frame_id: str
) -> OdometryMessage:
    """Message of the pose in ``frame_id`` and the twist in ``child_frame_id``, covariances zero."""
    message = OdometryMessage() if into is None else into
    fill_header(message.header, state.stamp_ns, frame_id)
    message.child_frame_id = child_frame_id
    pose, twist = message.pose.pose, message.twist.twist
    fill_vector(pose.position, *state.position_m.tolist())
    fill_quaternion(pose.orientation, quaternion_from_roll_pitch_yaw(*state.roll_pitch_yaw_rad.tolist()))
    fill_vector(twist.linear, *state.velocity_mps.tolist())
    fill_vector(twist.angular, *state.angular_velocity_radps.tolist())
    return message


def vertical_acceleration_from_message(message: AccelStamped) -> tuple[int, float]:
    """Stamp (ns) and world-vertical acceleration of the base, gravity removed (m/s^2)."""
    stamp_ns, _ = header_from_message(message.header)
    return stamp_ns, require_finite("linear.z", message.accel.linear.z)


def vertical_acceleration_to_message(
    state: BodyState, into: AccelStamped | None = None, *, frame_id: str
) -> AccelStamped:
    """Message with the world-vertical acceleration of the base in linear.z; the rest is not known and zero."""
    message = AccelStamped() if into is None else into
    fill_header(message.header, state.stamp_ns, frame_id)
    message.accel.linear.z = float(state.vertical_acceleration_mps2)
    return message
