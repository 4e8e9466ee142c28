import numpy as np
import pytest

from tracked_bringup.odom_origin import OdomOrigin
from tracked_types import Odometry, Pose2, Twist2


def odometry(stamp_ns: int, pose: Pose2) -> Odometry:
    return Odometry(stamp_ns, "odom", "base", pose, Twist2(0.0, 0.0), np.eye(3), np.eye(2))


def test_the_first_common_stamp_tells_where_the_frame_lies() -> None:
    origin, frame = OdomOrigin(), Pose2(1.0, -2.0, 0.7)
    origin.add_truth(1, Pose2(9.0, 9.0, 9.0))
    origin.add_odometry(odometry(2, Pose2(0.3, 0.1, 0.2)))
    assert origin.pose is None
    origin.add_truth(2, frame.compose(Pose2(0.3, 0.1, 0.2)))
    assert origin.pose is not None and origin.pose.as_array() == pytest.approx(frame.as_array())
    origin.add_truth(3, Pose2(0.0, 0.0, 0.0))
    origin.add_odometry(odometry(3, Pose2(0.0, 0.0, 0.0)))
    assert origin.pose.as_array() == pytest.approx(frame.as_array())


def test_streams_that_never_meet_fill_no_memory() -> None:
    origin = OdomOrigin()
    for stamp_ns in range(0, 10_000, 2):
        origin.add_truth(stamp_ns, Pose2(0.0, 0.0, 0.0))
        origin.add_odometry(odometry(stamp_ns + 1, Pose2(0.0, 0.0, 0.0)))
    assert origin.pose is None and len(origin._truth) <= 300
