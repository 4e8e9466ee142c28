"""tracked_interfaces/Trajectory."""

from array import array

import numpy as np
from numpy.typing import NDArray
from tracked_interfaces.msg import Trajectory as TrajectoryMessage

from node_kit.conversions.checks import require_all_finite, require_size
from node_kit.conversions.headers import fill_header, header_from_message
from node_kit.rejection import RejectedMessage
from tracked_types import Trajectory, wrap_angle

LONGEST = 100_000  # points; longer messages are taken for nonsense


def trajectory_from_message(message: TrajectoryMessage) -> Trajectory:
    """Trajectory with wrapped headings.

    Raises
    ------
    RejectedMessage: stamp or frame cannot be used, arrays are empty, huge or of different sizes, a number is not
        finite, or times do not increase.
    """
    stamp_ns, frame_id = header_from_message(message.header)
    count = len(message.time_from_start)
    if not 1 <= count <= LONGEST:
        raise RejectedMessage(f"size of time_from_start is {count}, expected 1 to {LONGEST}")
    times = _column("time_from_start", message.time_from_start, count)
    if np.any(np.diff(times) <= 0.0):
        raise RejectedMessage("times do not increase")
    x, y, yaw = (_column(name, getattr(message, name), count) for name in ("x", "y", "yaw"))
    inputs = [_column(name, getattr(message, name), count) for name in ("speed", "yaw_rate")]
    return Trajectory(stamp_ns, frame_id, times, np.column_stack((x, y, wrap_angle(yaw))), np.column_stack(inputs))


def trajectory_to_message(trajectory: Trajectory, into: TrajectoryMessage | None = None) -> TrajectoryMessage:
    """Message of all points; ``into`` is a message to overwrite."""
    message = TrajectoryMessage() if into is None else into
    fill_header(message.header, trajectory.stamp_ns, trajectory.frame_id)
    message.time_from_start = _array(trajectory.times_s)
    message.x, message.y, message.yaw = map(_array, trajectory.states.T)
    message.speed, message.yaw_rate = map(_array, trajectory.inputs.T)
    return message


def _column(name: str, values: "array[float]", count: int) -> NDArray[np.float64]:
    require_size(name, values, count)
    column = np.array(values, dtype=np.float64)
    require_all_finite(name, column)
    return column


def _array(values: NDArray[np.float64]) -> "array[float]":
    return array("d", np.ascontiguousarray(values, dtype=np.float64).tobytes())
