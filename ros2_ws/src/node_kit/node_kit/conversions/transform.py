"""tf2_msgs/TFMessage."""

from geometry_msgs.msg import TransformStamped
from tf2_msgs.msg import TFMessage

from node_kit.conversions.checks import require_frame
from node_kit.conversions.geometry import fill_quaternion, fill_vector, quaternion_from_message, vector_from_message
from node_kit.conversions.headers import fill_header, header_from_message
from node_kit.rejection import RejectedMessage
from node_kit.rigid_transform import RigidTransform, StampedTransform


def transforms_from_message(message: TFMessage) -> list[StampedTransform]:
    """All transforms of a message.

    Raises
    ------
    RejectedMessage: one of them has a stamp, frame, number or quaternion that cannot be used, or is its own parent.
    """
    return [_transform_from_message(transform) for transform in message.transforms]


def fill_transform(message: TransformStamped, stamped: StampedTransform) -> None:
    """Write a geometry_msgs/TransformStamped."""
    fill_header(message.header, stamped.stamp_ns, stamped.parent)
    message.child_frame_id = stamped.child
    fill_vector(message.transform.translation, *stamped.transform.translation_m)
    fill_quaternion(message.transform.rotation, stamped.transform.quaternion)


def _transform_from_message(message: TransformStamped) -> StampedTransform:
    stamp_ns, parent = header_from_message(message.header)
    child = require_frame("child_frame_id", message.child_frame_id)
    if parent == child:
        raise RejectedMessage("frame is its own parent")
    transform = RigidTransform(
        vector_from_message("translation", message.transform.translation),
        quaternion_from_message("rotation", message.transform.rotation),
    )
    return StampedTransform(stamp_ns, parent, child, transform)
