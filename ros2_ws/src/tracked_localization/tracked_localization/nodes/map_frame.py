"""What the nodes about maps share: the map's frame and the transform from it to the odometry's."""

from node_kit import BadParameterError, Parameter, StackNode
from tracked_types import Pose2, to_nanoseconds

MAP_FRAME = Parameter("map_frame", "map", "frame of the map")
INITIAL_POSE = Parameter("initial_pose", (0.0, 0.0, 0.0), "x (m), y (m) and yaw (rad) of the base in the map")
TOLERANCE = Parameter(
    "transform_tolerance_s",
    0.2,
    "map -> odom is stamped so far ahead of the scan it is from, and holds until the next",
    unit="s",
    low=0.0,
    high=2.0,
)


def pose_of(numbers: tuple[float, ...]) -> Pose2:
    """The pose that `INITIAL_POSE` says.

    Raises
    ------
    BadParameterError: these are not three numbers.
    """
    if len(numbers) != 3:
        raise BadParameterError(f"parameter {INITIAL_POSE.name} must be x, y and yaw, got {len(numbers)} numbers")
    return Pose2(*numbers)


class MapToOdom:
    """Sends map -> odom, each time for some moments to come."""

    def __init__(self, node: StackNode, odom_frame: str) -> None:
        self._node, self._odom_frame = node, odom_frame
        self._map_frame = node.frame(node.value(MAP_FRAME.name))
        self._ahead_ns = to_nanoseconds(node.value(TOLERANCE.name))
        self._sent: Pose2 | None = None
        node.transforms.advertise()

    def send(self, odom_in_map: Pose2, stamp_ns: int) -> None:
        """The odometry's frame lies here as of ``stamp_ns``."""
        # Whoever looks back finds nothing before the first one: let that one hold from its own instant on.
        stamps = (stamp_ns,) if self._sent is None else ()
        for sent_ns in (*stamps, stamp_ns + self._ahead_ns):
            x, y, yaw = odom_in_map.x_m, odom_in_map.y_m, odom_in_map.yaw_rad
            self._node.transforms.send(self._map_frame, self._odom_frame, x, y, 0.0, 0.0, 0.0, yaw, sent_ns)
        self._sent = odom_in_map
