"""sensor_msgs/LaserScan."""

import math
from array import array

import numpy as np
from sensor_msgs.msg import LaserScan as LaserScanMessage

from node_kit.conversions.checks import require_finite, require_not_negative
from node_kit.conversions.headers import fill_header, header_from_message
from node_kit.rejection import RejectedMessage
from tracked_types import LaserScan

MOST_BEAMS = 1_000_000
MOST_RAD = 4.0 * math.pi  # of single-precision angles beyond, sines are no longer what they seem
MOST_S = 60.0


def scan_from_message(message: LaserScanMessage) -> LaserScan:
    """Scan; ranges stay as REP-117 has them (inf: no return, -inf: too close, NaN: no measurement).

    Raises
    ------
    RejectedMessage: stamp, frame, angles, times or range limits cannot be used, or the number of ranges does not
        agree with the angles.
    """
    stamp_ns, frame_id = header_from_message(message.header)
    angle_min, angle_max = _angle("angle_min", message.angle_min), _angle("angle_max", message.angle_max)
    increment = require_finite("angle_increment", message.angle_increment)
    if increment == 0.0:
        raise RejectedMessage("zero: angle_increment")
    _require_beams(len(message.ranges), angle_max - angle_min, increment)
    time_increment = require_not_negative("time_increment", message.time_increment)
    scan_time = require_not_negative("scan_time", message.scan_time)
    if max(scan_time, time_increment * len(message.ranges)) > MOST_S:
        raise RejectedMessage(f"a revolution of more than {MOST_S:g} s")
    range_min = require_not_negative("range_min", message.range_min)
    if not range_min < message.range_max:
        raise RejectedMessage("range_max does not exceed range_min")
    return LaserScan(
        stamp_ns=stamp_ns,
        frame_id=frame_id,
        angle_min_rad=angle_min,
        angle_increment_rad=increment,
        time_increment_s=time_increment,
        scan_time_s=scan_time,
        range_min_m=range_min,
        range_max_m=message.range_max,
        ranges_m=np.array(message.ranges, dtype=np.float32),
    )


def scan_to_message(scan: LaserScan, into: LaserScanMessage | None = None) -> LaserScanMessage:
    """Message without intensities; ``into`` is a message to overwrite."""
    message = LaserScanMessage() if into is None else into
    fill_header(message.header, scan.stamp_ns, scan.frame_id)
    beams = len(scan.ranges_m)
    message.angle_min = float(scan.angle_min_rad)
    message.angle_max = float(scan.angle_min_rad + (beams - 1) * scan.angle_increment_rad)
    message.angle_increment = float(scan.angle_increment_rad)
    message.time_increment = float(scan.time_increment_s)
    message.scan_time = float(scan.scan_time_s)
    message.range_min = float(scan.range_min_m)
    message.range_max = float(scan.range_max_m)
    message.ranges = array("f", np.ascontiguousarray(scan.ranges_m, dtype=np.float32).tobytes())
    return message


def _angle(name: str, value: float) -> float:
    if abs(require_finite(name, value)) > MOST_RAD:
        raise RejectedMessage(f"more than two turns: {name}")
    return value


def _require_beams(beams: int, span: float, increment: float) -> None:
    """One beam of disagreement is allowed: drivers differ in whether the last angle is a beam."""
    if not 1 <= beams <= MOST_BEAMS:
        raise RejectedMessage(f"size of ranges is {beams}, expected 1 to {MOST_BEAMS}")
    expected = span / increment + 1.0
    if not abs(expected - beams) <= 1.0 + 1e-3 * beams:
        raise RejectedMessage("size of ranges disagrees with the angles")
