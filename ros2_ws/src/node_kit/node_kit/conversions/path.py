"""nav_msgs/Path of planar poses, for viewers."""

import numpy as np
from geometry_msgs.msg import PoseStamped
from nav_msgs.msg import Path
from numpy.typing import NDArray

from node_kit.conversions.geometry import fill_quaternion
from node_kit.conversions.headers import fill_header
from node_kit.rotations import quaternion_from_yaw


def path_to_message(poses: NDArray[np.float64], stamp_ns: int, frame_id: str) -> Path:
    """Message of poses (n, 3): x, y (m) and heading (rad) in ``frame_id``."""
    message = Path()
    fill_header(message.header, stamp_ns, frame_id)
    for x, y, yaw in poses.tolist():
        pose = PoseStamped()
        fill_header(pose.header, stamp_ns, frame_id)
        pose.pose.position.x, pose.pose.position.y = x, y
        fill_quaternion(pose.pose.orientation, quaternion_from_yaw(yaw))
        message.poses.append(pose)
    return message
