import numpy as np
import pytest

from tracked_localization.localisation.odometry_anchor import AnchorSettings, OdometryAnchor
from tracked_types import Pose2

SECOND_NS, HERE = 10**9, Pose2(0.0, 0.0, 0.0)
IN_MAP = Pose2(2.0, 1.0, np.pi / 2)


def pinned():
    anchor = OdometryAnchor(AnchorSettings())
    anchor.pin(IN_MAP, 0)
    return anchor


def test_a_loose_anchor_measures_nothing():
    anchor = OdometryAnchor(AnchorSettings())
    assert anchor.measured(HERE, np.eye(3), 0, "odom") is None and not anchor.check(HERE, HERE, 0)
    anchor.pin(IN_MAP, 0)
    anchor.loosen()
    assert anchor.odom_in_map is None


def test_a_pose_in_the_map_is_measured_in_the_odometrys_axes():
    sample = pinned().measured(IN_MAP.compose(Pose2(1.0, 0.0, 0.2)), np.diag([1e4, 1e2, 1e6]), 7, "odom")
    assert sample.stamp_ns == 7 and sample.frame_id == "odom"
    assert sample.pose.as_array() == pytest.approx([1.0, 0.0, 0.2])
    assert np.diag(sample.covariance) == pytest.approx([1e-2, 1e-4, 1e-6], rel=1e-3)


def test_what_a_scan_does_not_show_is_measured_with_no_confidence():
    sample = pinned().measured(IN_MAP, np.diag([0.0, 1e4, 1e6]), 0, "odom")
    assert sample.covariance[1, 1] > 100.0 and sample.covariance[0, 0] < 1e-3
    assert np.linalg.eigvalsh(sample.covariance).min() > 0.0


def test_odometry_that_does_not_follow_for_long_is_pinned_anew():
    anchor, off = pinned(), IN_MAP.compose(Pose2(0.5, 0.0, 0.0))
    assert not anchor.check(off, HERE, SECOND_NS)  # not yet
    assert anchor.check(off, HERE, 3 * SECOND_NS)
    assert anchor.odom_in_map.as_array() == pytest.approx(off.as_array())


def test_odometry_that_comes_back_in_time_stays_pinned():
    anchor, off = pinned(), IN_MAP.compose(Pose2(0.5, 0.0, 0.0))
    assert not anchor.check(off, HERE, SECOND_NS)
    assert not anchor.check(IN_MAP, HERE, 2 * SECOND_NS)
    assert not anchor.check(off, HERE, 3 * SECOND_NS)
    assert anchor.odom_in_map == IN_MAP


def test_a_clock_that_is_set_back_is_no_long_absence():
    anchor, off = pinned(), IN_MAP.compose(Pose2(0.5, 0.0, 0.0))
    anchor.check(IN_MAP, HERE, 100 * SECOND_NS)
    assert not anchor.check(off, HERE, SECOND_NS) and not anchor.check(off, HERE, 2 * SECOND_NS)
