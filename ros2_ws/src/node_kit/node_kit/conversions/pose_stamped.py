"""geometry_msgs/PoseStamped of a planar pose, such as a goal."""

from geometry_msgs.msg import PoseStamped

from node_kit.conversions.geometry import fill_quaternion, quaternion_from_message, vector_from_message
from node_kit.conversions.headers import fill_header, header_from_message
from node_kit.rotations import quaternion_from_yaw, yaw_from_quaternion
from tracked_types import Pose2, StampedPose


def pose_stamped_from_message(message: PoseStamped) -> StampedPose:
    """Planar part of a pose.

    Raises
    ------
    RejectedMessage: stamp, frame, a number or the quaternion cannot be used.
    """
    stamp_ns, frame_id = header_from_message(message.header)
    x, y, _ = vector_from_message("position", message.pose.position)
    quaternion = quaternion_from_message("orientation", message.pose.orientation)
    return StampedPose(stamp_ns, frame_id, Pose2(x, y, yaw_from_quaternion(*quaternion)))


def pose_stamped_to_message(stamped: StampedPose, into: PoseStamped | None = None) -> PoseStamped:
    """Message with zeros off the plane; ``into`` is a message of this function to overwrite."""
    message = PoseStamped() if into is None else into
    fill_header(message.header, stamped.stamp_ns, stamped.frame_id)
    message.pose.position.x, message.pose.position.y = float(stamped.pose.x_m), float(stamped.pose.y_m)
    fill_quaternion(message.pose.orientation, quaternion_from_yaw(stamped.pose.yaw_rad))
    return message
