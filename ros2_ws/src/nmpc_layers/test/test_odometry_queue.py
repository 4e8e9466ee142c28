import numpy as np

from nmpc_layers.odometry_queue import LONGEST, OdometryQueue
from tracked_types import Odometry, Pose2, Twist2


def odometry(stamp_ns):
    return Odometry(stamp_ns, "odom", "base", Pose2(0.0, 0.0, 0.0), Twist2(0.0, 0.0), np.eye(3), np.eye(2))


def test_ticks_wait_in_order_for_what_they_lack():
    lacking, ticked = {2}, []
    queue = OdometryQueue(lacking.__contains__, lambda each: ticked.append(each.stamp_ns))
    for stamp_ns in (1, 2, 3):
        queue.add(odometry(stamp_ns))
    assert ticked == [1]
    lacking.clear()
    queue.work_off()
    assert ticked == [1, 2, 3]


def test_time_that_is_not_locked_is_not_waited_for_and_that_is_told():
    ticked, told = [], []
    queue = OdometryQueue(lambda _: True, lambda each: ticked.append(each.stamp_ns), told.append)
    for stamp_ns in range(LONGEST - 1):
        queue.add(odometry(stamp_ns))
    assert not ticked and not told
    queue.add(odometry(LONGEST - 1))
    assert ticked == list(range(LONGEST))
    assert told == [LONGEST]
