"""tracked_interfaces/SlipEstimate."""

from tracked_interfaces.msg import SlipEstimate

from node_kit.conversions.checks import require_finite, require_not_negative
from node_kit.conversions.headers import fill_header, header_from_message
from tracked_types import Slip


def slip_from_message(message: SlipEstimate) -> Slip:
    """Slip of a track pair.

    Raises
    ------
    RejectedMessage: stamp or frame cannot be used, a number is not finite, or a variance is negative.
    """
    stamp_ns, _ = header_from_message(message.header)
    return Slip(
        stamp_ns,
        require_finite("speed", message.speed),
        require_finite("yaw_rate", message.yaw_rate),
        require_not_negative("speed_variance", message.speed_variance),
        require_not_negative("yaw_rate_variance", message.yaw_rate_variance),
        bool(message.known),
        bool(message.speed_measured),
        require_finite("slide", message.slide),
    )


def slip_to_message(slip: Slip, into: SlipEstimate | None = None, *, frame_id: str) -> SlipEstimate:
    """Message in the base frame ``frame_id``."""
    message = SlipEstimate() if into is None else into
    fill_header(message.header, slip.stamp_ns, frame_id)
    message.speed = float(slip.speed_mps)
    message.yaw_rate = float(slip.yaw_rate_radps)
    message.speed_variance = float(slip.speed_variance)
    message.yaw_rate_variance = float(slip.yaw_rate_variance)
    message.known = bool(slip.known)
    message.speed_measured = bool(slip.speed_measured)
    message.slide = float(slip.slide_s)
    return message
