"""geometry_msgs/Twist and TwistStamped."""

from geometry_msgs.msg import Twist, TwistStamped

from node_kit.conversions.geometry import vector_from_message
from node_kit.conversions.headers import fill_header, stamp_from_message
from tracked_types import Twist2, VelocityCommand


def twist_from_message(message: Twist) -> Twist2:
    """Forward speed and yaw rate; the other components must be finite and are ignored.

    Raises
    ------
    RejectedMessage: a number is not finite.
    """
    speed, _, _ = vector_from_message("linear", message.linear)
    _, _, yaw_rate = vector_from_message("angular", message.angular)
    return Twist2(speed, yaw_rate)


def twist_to_message(twist: Twist2, into: Twist | None = None) -> Twist:
    """Message with forward speed and yaw rate, the rest zero."""
    message = Twist() if into is None else into
    message.linear.x = float(twist.speed_mps)
    message.angular.z = float(twist.yaw_rate_radps)
    return message


def command_from_message(message: TwistStamped) -> VelocityCommand:
    """Command with the stamp of the odometry it answers; the frame is the base by convention and not read.

    Raises
    ------
    RejectedMessage: the stamp cannot be used or a number is not finite.
    """
    return VelocityCommand(stamp_from_message(message.header.stamp), twist_from_message(message.twist))


def command_to_message(
    command: VelocityCommand, into: TwistStamped | None = None, *, frame_id: str = ""
) -> TwistStamped:
    """Message in the base frame ``frame_id``."""
    message = TwistStamped() if into is None else into
    fill_header(message.header, command.stamp_ns, frame_id)
    twist_to_message(command.twist, message.twist)
    return message
