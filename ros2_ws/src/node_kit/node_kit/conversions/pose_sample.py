"""geometry_msgs/PoseWithCovarianceStamped of a measured planar pose."""

from geometry_msgs.msg import PoseWithCovarianceStamped

from node_kit.conversions.checks import checked_covariance
from node_kit.conversions.geometry import (
    PLANAR,
    PLANAR_BLOCK,
    fill_quaternion,
    quaternion_from_message,
    sub_covariance,
    vector_from_message,
)
from node_kit.conversions.headers import fill_header, header_from_message
from node_kit.rotations import quaternion_from_yaw, yaw_from_quaternion
from tracked_types import Pose2, PoseSample


def pose_sample_from_message(message: PoseWithCovarianceStamped) -> PoseSample:
    """Planar part of a measured pose.

    Raises
    ------
    RejectedMessage: stamp, frame, a number, the quaternion or the covariance cannot be used.
    """
    stamp_ns, frame_id = header_from_message(message.header)
    x, y, _ = vector_from_message("position", message.pose.pose.position)
    quaternion = quaternion_from_message("orientation", message.pose.pose.orientation)
    covariance = checked_covariance("pose covariance", message.pose.covariance, 6)
    return PoseSample(
        stamp_ns, frame_id, Pose2(x, y, yaw_from_quaternion(*quaternion)), sub_covariance(covariance, PLANAR)
    )


def pose_sample_to_message(
    sample: PoseSample, into: PoseWithCovarianceStamped | None = None
) -> PoseWithCovarianceStamped:
    """Message with zeros off the plane; ``into`` is a message of this function to overwrite."""
    message = PoseWithCovarianceStamped() if into is None else into
    fill_header(message.header, sample.stamp_ns, sample.frame_id)
    pose = message.pose.pose
    pose.position.x, pose.position.y = float(sample.pose.x_m), float(sample.pose.y_m)
    fill_quaternion(pose.orientation, quaternion_from_yaw(sample.pose.yaw_rad))
    message.pose.covariance[PLANAR_BLOCK] = sample.covariance.ravel()
    return message
