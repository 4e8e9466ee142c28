import contextlib
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tracked_description import load_robot
from tracked_safety.bench_inputs import BEAMS, odometry, ranges_of, scan
from tracked_safety.guard_settings import GuardSettings
from tracked_safety.scan_view import ScanRefused, ScanView
from tracked_types import Pose2, Twist2, to_nanoseconds

SETTINGS = GuardSettings.from_robot(load_robot())
FREE = np.full(BEAMS, np.inf)
POST = (1.5, 0.4)


def driving(speed, turn, last_s, first_s=0.0):
    """A view with the odometry of a drive, and the pose at any time."""

    def pose_at(time_s):
        yaw = turn * time_s
        return Pose2(
            speed * time_s * np.sinc(yaw / np.pi), 0.5 * speed * yaw * time_s * np.sinc(yaw / 2 / np.pi) ** 2, yaw
        )

    view = ScanView(SETTINGS)
    for index in range(round(first_s * 60), round(last_s * 60) + 1):
        view.add_odometry(odometry(index / 60, pose_at(index / 60), Twist2(speed, turn)))
    return view, pose_at


def swept(pose_at, start_s):
    """A revolution during which the robot moves past a post."""
    ranges = FREE.copy()
    for beam in range(BEAMS):
        lidar = pose_at(start_s + 0.1 * beam / BEAMS).compose(SETTINGS.lidar)
        ranges[beam] = ranges_of([POST], lidar)[beam]
    return scan(to_nanoseconds(start_s), ranges)


def refusal(view, offered):
    with pytest.raises(ScanRefused) as refused:
        view.add_scan(offered)
    return refused.value.reason


@pytest.mark.parametrize(("speed", "turn"), [(0.5, 0.0), (0.0, 1.3), (0.4, -1.0)])
def test_points_are_where_they_are_now_though_the_robot_moved_while_and_since_the_beams_fired(speed, turn):
    view, pose_at = driving(speed, turn, 0.5)
    view.add_scan(swept(pose_at, 0.3))
    for now_s in (0.4, 0.5, 0.55):
        there = pose_at(now_s).inverse().transform(np.array([POST]))
        found = view.points(to_nanoseconds(now_s))
        assert len(found) >= 1
        assert np.abs(found - there).max() < 0.02  # half the way between two beams at 1.5 m is 13 mm


def test_beams_that_come_back_too_soon_are_obstacles_and_nan_is_none():
    view, _ = driving(0.0, 0.0, 0.3)
    ranges = FREE.copy()
    ranges[:3] = [-np.inf, np.nan, 0.01]
    view.add_scan(scan(to_nanoseconds(0.2), ranges))
    assert len(view.points(to_nanoseconds(0.3))) == 1


@pytest.mark.parametrize("ranges", [np.full(BEAMS, np.nan), np.zeros(BEAMS), np.array([]), np.full(BEAMS, 1e9)])
def test_a_scan_that_says_nothing_is_refused_and_ages_what_was_known(ranges):
    view, _ = driving(0.0, 0.0, 0.3)
    view.add_scan(scan(to_nanoseconds(0.1), FREE))
    assert refusal(view, scan(to_nanoseconds(0.2), ranges)) == "too few beams measured anything"
    assert len(view.points(to_nanoseconds(0.45))) == 0
    assert view.points(to_nanoseconds(0.51)) == "the scan is older than 0.3 s"


@pytest.mark.parametrize(
    ("stamp_s", "reason"),
    [
        (0.9, "stamp repeated or out of order"),
        (0.85, "stamp repeated or out of order"),
        (1.2, "stamp in the future"),
        (1e6, "stamp in the future"),
        (0.0, "stale stamp"),
    ],
)
def test_a_scan_out_of_time_is_refused_with_its_reason(stamp_s, reason):
    view, _ = driving(0.0, 0.0, 1.0)
    view.add_scan(scan(to_nanoseconds(0.9), FREE))
    assert refusal(view, scan(to_nanoseconds(stamp_s), FREE)) == reason


def test_a_scan_from_the_future_that_came_before_the_odometry_does_not_blind_for_good():
    view = ScanView(SETTINGS)
    view.add_scan(scan(to_nanoseconds(1e9), FREE))
    view.add_odometry(odometry(1.0))
    view.add_scan(scan(to_nanoseconds(0.9), FREE))
    assert len(view.points(to_nanoseconds(1.0))) == 0


def test_an_odometry_that_jumps_cannot_carry_a_scan_on():
    view, _ = driving(0.0, 0.0, 1.0)
    view.add_scan(scan(to_nanoseconds(0.9), FREE))
    view.add_odometry(odometry(1.02, Pose2(5.0, 0.0, 0.0)))
    assert view.points(to_nanoseconds(1.02)) == "the odometry does not reach back to the scan"
    view.add_scan(scan(to_nanoseconds(1.0), FREE))
    assert len(view.points(to_nanoseconds(1.1))) == 0


def test_odometry_that_has_ceased_cannot_carry_a_scan_on():
    view, _ = driving(0.5, 0.0, 1.0)
    view.add_scan(scan(to_nanoseconds(0.95), FREE))
    assert view.points(to_nanoseconds(1.25)) == "the odometry does not reach back to the scan"


def test_a_jump_of_the_clock_asks_for_a_new_scan():
    view, _ = driving(0.0, 0.0, 1.0)
    view.add_scan(scan(to_nanoseconds(0.9), FREE))
    view.forget()
    assert view.points(to_nanoseconds(1.0)) == "no scan yet"
    view.add_odometry(odometry(0.2))
    view.add_scan(scan(to_nanoseconds(0.1), FREE))
    assert len(view.points(to_nanoseconds(0.2))) == 0


def test_the_next_scan_is_due_when_its_last_beam_is():
    view, _ = driving(0.0, 0.0, 1.0)
    assert view.next_ns is None
    view.add_scan(scan(to_nanoseconds(0.9), FREE))
    assert view.next_ns == to_nanoseconds(1.1)
    view.expect_none()
    assert view.next_ns is None
    at_once = replace(scan(to_nanoseconds(1.0), FREE), time_increment_s=0.0)
    view.add_scan(at_once)
    assert view.next_ns == to_nanoseconds(1.1)


@given(
    ranges=st.lists(st.floats(width=32), max_size=40),
    stamp_ns=st.integers(0, 2 * 10**9),
    time_increment=st.floats(0.0, 60.0),
    scan_time=st.floats(0.0, 60.0),
    now_ns=st.integers(0, 3 * 10**9),
)
def test_whatever_a_scan_holds_it_gives_finite_points_or_a_reason(ranges, stamp_ns, time_increment, scan_time, now_ns):
    view, _ = driving(0.3, 0.2, 1.0)
    made = replace(scan(stamp_ns, ranges), time_increment_s=time_increment / max(len(ranges), 1), scan_time_s=scan_time)
    with contextlib.suppress(ScanRefused):
        view.add_scan(made)
    points = view.points(now_ns)
    assert isinstance(points, str) or np.isfinite(points).all()
