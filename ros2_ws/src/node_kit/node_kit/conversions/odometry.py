"""nav_msgs/Odometry of an estimate on the floor, tilted as the base is."""

from nav_msgs.msg import Odometry as OdometryMessage

from node_kit.conversions.checks import checked_covariance, require_frame
from node_kit.conversions.geometry import (
    PLANAR,
    PLANAR_BLOCK,
    SPEED_AND_YAW_RATE,
    SPEED_BLOCK,
    fill_quaternion,
    quaternion_from_message,
    sub_covariance,
    vector_from_message,
)
from node_kit.conversions.headers import fill_header, header_from_message
from node_kit.rotations import quaternion_from_roll_pitch_yaw, roll_pitch_yaw_from_quaternion
from tracked_types import Odometry, Pose2, Twist2


def odometry_from_message(message: OdometryMessage) -> Odometry:
    """Place on the floor, tilt and twist of an odometry message.

    Raises
    ------
    RejectedMessage: stamp, a frame, a number, the quaternion or a covariance cannot be used.
    """
    stamp_ns, frame_id = header_from_message(message.header)
    child_frame_id = require_frame("child_frame_id", message.child_frame_id)
    pose, twist = message.pose.pose, message.twist.twist
    x, y, _ = vector_from_message("position", pose.position)
    quaternion = quaternion_from_message("orientation", pose.orientation)
    speed, _, _ = vector_from_message("linear", twist.linear)
    _, _, yaw_rate = vector_from_message("angular", twist.angular)
    pose_covariance = checked_covariance("pose covariance", message.pose.covariance, 6)
    twist_covariance = checked_covariance("twist covariance", message.twist.covariance, 6)
    roll, pitch, yaw = roll_pitch_yaw_from_quaternion(*quaternion)
    return Odometry(
        stamp_ns,
        frame_id,
        child_frame_id,
        Pose2(x, y, yaw),
        Twist2(speed, yaw_rate),
        sub_covariance(pose_covariance, PLANAR),
        sub_covariance(twist_covariance, SPEED_AND_YAW_RATE),
        roll,
        pitch,
    )


def odometry_to_message(odometry: Odometry, into: OdometryMessage | None = None) -> OdometryMessage:
    """Message with height zero; ``into`` is a message of this function to overwrite."""
    message = OdometryMessage() if into is None else into
    fill_header(message.header, odometry.stamp_ns, odometry.frame_id)
    message.child_frame_id = odometry.child_frame_id
    pose, twist = message.pose.pose, message.twist.twist
    pose.position.x, pose.position.y = float(odometry.pose.x_m), float(odometry.pose.y_m)
    roll, pitch, yaw = odometry.roll_rad, odometry.pitch_rad, odometry.pose.yaw_rad
    fill_quaternion(pose.orientation, quaternion_from_roll_pitch_yaw(roll, pitch, yaw))
    twist.linear.x, twist.angular.z = float(odometry.twist.speed_mps), float(odometry.twist.yaw_rate_radps)
    message.pose.covariance[PLANAR_BLOCK] = odometry.pose_covariance.ravel()
    message.twist.covariance[SPEED_BLOCK] = odometry.twist_covariance.ravel()
    return message
