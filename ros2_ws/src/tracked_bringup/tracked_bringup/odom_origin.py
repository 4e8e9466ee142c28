"""Where the odom frame lies in the world, from the first instants of a run."""

from tracked_types import Odometry, Pose2

_MOST_WAITING = 300


class OdomOrigin:
    """Pairs an odometry with the truth of the same stamp; the first pair tells, later ones are ignored."""

    def __init__(self) -> None:
        self.pose: Pose2 | None = None
        self._odometry: dict[int, Pose2] = {}
        self._truth: dict[int, Pose2] = {}

    def add_odometry(self, odometry: Odometry) -> None:
        """Pose in the odom frame."""
        self._add(self._odometry, odometry.stamp_ns, odometry.pose)

    def add_truth(self, stamp_ns: int, pose: Pose2) -> None:
        """Pose in the world."""
        self._add(self._truth, stamp_ns, pose)

    def _add(self, poses: dict[int, Pose2], stamp_ns: int, pose: Pose2) -> None:
        if self.pose is not None or len(poses) >= _MOST_WAITING:
            return
        poses[stamp_ns] = pose
        if stamp_ns in self._odometry and stamp_ns in self._truth:
            self.pose = self._truth[stamp_ns].compose(self._odometry[stamp_ns].inverse())
