"""nav_msgs/OccupancyGrid."""

from array import array

import numpy as np
from nav_msgs.msg import OccupancyGrid

from node_kit.conversions.checks import require_finite
from node_kit.conversions.geometry import fill_quaternion, quaternion_from_message, vector_from_message
from node_kit.conversions.headers import fill_header, fill_stamp, header_from_message
from node_kit.rejection import RejectedMessage
from node_kit.rotations import quaternion_from_yaw, yaw_from_quaternion
from tracked_types import OCCUPIED, UNKNOWN, OccupancyMap, Pose2

MOST_CELLS = 2**28
_TILT_TOLERANCE = 1e-3  # of the quaternion's x and y


def occupancy_grid_from_message(message: OccupancyGrid) -> OccupancyMap:
    """Map of the ground plane; its stamp and load time say nothing of it and are not kept.

    Raises
    ------
    RejectedMessage: stamp, frame, resolution, size or origin cannot be used, the number of cells is not width x
        height, or a cell is neither unknown (-1) nor 0 to 100.
    """
    _, frame_id = header_from_message(message.header)
    info = message.info
    if require_finite("resolution", info.resolution) <= 0.0:
        raise RejectedMessage("not positive: resolution")
    width, height, cells = int(info.width), int(info.height), len(message.data)
    if not 0 < width * height <= MOST_CELLS:
        raise RejectedMessage(f"{width} x {height} cells, expected 1 to {MOST_CELLS}")
    if cells != width * height:
        raise RejectedMessage(f"size of data is {cells}, expected {width} x {height}")
    x, y, _ = vector_from_message("origin", info.origin.position)
    quaternion = quaternion_from_message("origin", info.origin.orientation)
    if max(abs(quaternion[0]), abs(quaternion[1])) > _TILT_TOLERANCE:
        raise RejectedMessage("tilted: origin")
    occupancy = np.array(message.data, np.int8)
    if occupancy.min() < UNKNOWN or occupancy.max() > OCCUPIED:
        raise RejectedMessage(f"a cell is outside {UNKNOWN} to {OCCUPIED}")
    origin = Pose2(x, y, yaw_from_quaternion(*quaternion))
    return OccupancyMap(frame_id, info.resolution, origin, occupancy.reshape(height, width))


def occupancy_grid_to_message(
    occupancy_map: OccupancyMap, stamp_ns: int = 0, into: OccupancyGrid | None = None
) -> OccupancyGrid:
    """Message of a map as of ``stamp_ns``; ``into`` is a message to overwrite."""
    message = OccupancyGrid() if into is None else into
    fill_header(message.header, stamp_ns, occupancy_map.frame_id)
    info, origin = message.info, occupancy_map.origin
    fill_stamp(info.map_load_time, stamp_ns)
    info.resolution = float(occupancy_map.resolution_m)
    info.height, info.width = occupancy_map.occupancy.shape
    info.origin.position.x, info.origin.position.y = float(origin.x_m), float(origin.y_m)
    fill_quaternion(info.origin.orientation, quaternion_from_yaw(origin.yaw_rad))
    message.data = array("b", np.ascontiguousarray(occupancy_map.occupancy).tobytes())
    return message
