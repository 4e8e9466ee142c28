"""Stamps and headers."""

from typing import Any

from node_kit.conversions.checks import require_frame
from node_kit.rejection import RejectedMessage
from tracked_types import NANOSECONDS_PER_SECOND


def stamp_from_message(stamp: Any) -> int:
    """Nanoseconds of a builtin_interfaces/Time; zero is a valid stamp (simulated time starts there)."""
    if stamp.sec < 0:
        raise RejectedMessage("negative: stamp")
    if stamp.nanosec >= NANOSECONDS_PER_SECOND:
        raise RejectedMessage("nanoseconds beyond a second: stamp")
    return int(stamp.sec) * NANOSECONDS_PER_SECOND + int(stamp.nanosec)


def fill_stamp(stamp: Any, stamp_ns: int) -> None:
    """Write ``stamp_ns`` into a builtin_interfaces/Time."""
    stamp.sec, stamp.nanosec = divmod(int(stamp_ns), NANOSECONDS_PER_SECOND)


def header_from_message(header: Any) -> tuple[int, str]:
    """Stamp (ns) and frame of a std_msgs/Header that must name a frame."""
    return stamp_from_message(header.stamp), require_frame("header.frame_id", header.frame_id)


def fill_header(header: Any, stamp_ns: int, frame_id: str) -> None:
    """Write stamp and frame into a std_msgs/Header."""
    fill_stamp(header.stamp, stamp_ns)
    header.frame_id = frame_id
