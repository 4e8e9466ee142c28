"""tracked_interfaces/Traction."""

from tracked_interfaces.msg import Traction as TractionMessage

from node_kit.conversions.checks import require_finite, require_not_negative
from node_kit.conversions.headers import fill_header, header_from_message
from node_kit.rejection import RejectedMessage
from tracked_types import Grip, Traction

_CODES = {grip: getattr(TractionMessage, grip.name) for grip in Grip}
_GRIPS = {code: grip for grip, code in _CODES.items()}


def traction_from_message(message: TractionMessage) -> Traction:
    """Whether the robot follows its tracks.

    Raises
    ------
    RejectedMessage: stamp, frame or grip cannot be used, a number is not finite, or a variance is negative.
    """
    stamp_ns, _ = header_from_message(message.header)
    grip = _GRIPS.get(message.grip)
    if grip is None:
        raise RejectedMessage(f"unknown grip: {message.grip}")
    return Traction(
        stamp_ns,
        grip,
        message.witness,
        message.reason,
        require_finite("lost_share", message.lost_share),
        require_not_negative("lost_share_variance", message.lost_share_variance),
        require_finite("yaw_multiplier", message.yaw_multiplier),
        require_not_negative("yaw_multiplier_variance", message.yaw_multiplier_variance),
    )


def traction_to_message(traction: Traction, into: TractionMessage | None = None, *, frame_id: str) -> TractionMessage:
    """Message in the base frame ``frame_id``."""
    message = TractionMessage() if into is None else into
    fill_header(message.header, traction.stamp_ns, frame_id)
    message.grip, message.witness, message.reason = _CODES[traction.grip], traction.witness, traction.reason
    message.lost_share = float(traction.lost_share)
    message.lost_share_variance = float(traction.lost_share_variance)
    message.yaw_multiplier = float(traction.yaw_multiplier)
    message.yaw_multiplier_variance = float(traction.yaw_multiplier_variance)
    return message
