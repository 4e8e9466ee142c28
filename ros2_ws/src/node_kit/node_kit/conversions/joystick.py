"""sensor_msgs/Joy."""

from array import array

from sensor_msgs.msg import Joy

from node_kit.conversions.checks import require_finite
from node_kit.conversions.headers import fill_header, stamp_from_message
from node_kit.rejection import RejectedMessage
from tracked_types import Joystick

MOST_CONTROLS = 256
_LARGEST = 1.001  # drivers scale whole numbers, and round


def joystick_from_message(message: Joy) -> Joystick:
    """Axes and buttons; the frame says nothing of a joystick.

    Raises
    ------
    RejectedMessage: the stamp cannot be used, or an axis is not finite or beyond its ends.
    """
    stamp_ns = stamp_from_message(message.header.stamp)
    if max(len(message.axes), len(message.buttons)) > MOST_CONTROLS:
        raise RejectedMessage(f"more than {MOST_CONTROLS} axes or buttons")
    for value in message.axes:
        if abs(require_finite("axes", value)) > _LARGEST:
            raise RejectedMessage("beyond -1 to 1: axes")
    return Joystick(stamp_ns, tuple(map(float, message.axes)), tuple(value != 0 for value in message.buttons))


def joystick_to_message(joystick: Joystick, into: Joy | None = None) -> Joy:
    """Message of a joystick."""
    message = Joy() if into is None else into
    fill_header(message.header, joystick.stamp_ns, "joy")
    message.axes = array("f", joystick.axes)
    message.buttons = array("i", map(int, joystick.buttons))
    return message
