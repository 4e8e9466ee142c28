"""rosgraph_msgs/Clock."""

from rosgraph_msgs.msg import Clock

from node_kit.conversions.headers import fill_stamp, stamp_from_message


def clock_from_message(message: Clock) -> int:
    """Simulated time (ns)."""
    return stamp_from_message(message.clock)


def clock_to_message(stamp_ns: int, into: Clock | None = None) -> Clock:
    """Message of a simulated time (ns)."""
    message = Clock() if into is None else into
    fill_stamp(message.clock, stamp_ns)
    return message
