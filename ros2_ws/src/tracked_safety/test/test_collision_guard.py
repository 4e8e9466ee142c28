import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tracked_description import load_robot
from tracked_safety.bench_inputs import odometry, ranges_of, scan
from tracked_safety.collision_guard import CollisionGuard
from tracked_safety.guard_settings import GuardSettings
from tracked_types import GuardAction, Pose2, Twist2

NOW_NS = 10**9
ROBOT = load_robot()
SETTINGS = GuardSettings.from_robot(ROBOT)
REST, AHEAD, STILL = Twist2(0.0, 0.0), Twist2(0.5, 0.0), Pose2(0.0, 0.0, 0.0)
FRONT_M = SETTINGS.footprint.front_m
BEHIND = Twist2(-0.4, 0.0)


class Seen(CollisionGuard):
    """A guard that is told points instead of scans."""

    def __init__(self, *points, settings=SETTINGS):
        super().__init__(settings)
        self.view.points = lambda now_ns: np.array(points, float).reshape(-1, 2)


def permitted(twist, *points, **how):
    return Seen(*points).permitted(twist, NOW_NS, **how)


def stop(twist, settings, points):
    """Least distance of the footprint from the points while the robot obeys, then brakes to rest."""
    pose, speed, time_s, least = STILL, 1.0, 0.0, math.inf
    pace = max(abs(twist.speed_mps), 0.5 * abs(twist.yaw_rate_radps))
    while speed > 0.0:
        least = min(least, settings.footprint.distance(pose.inverse().transform(points)).min())
        if time_s > settings.reaction_s + settings.delay_s:
            speed -= settings.braking_mps2 * 0.005 / pace
        pose = pose.compose(Pose2(0.005 * speed * twist.speed_mps, 0.0, 0.005 * speed * twist.yaw_rate_radps))
        time_s += 0.005
    return least


@settings(max_examples=200, deadline=None)
@given(
    points=st.lists(st.tuples(st.floats(-2.0, 2.0), st.floats(-2.0, 2.0)), min_size=1, max_size=6),
    speed=st.floats(-0.4, 0.5),
    turn=st.floats(-1.3, 1.3),
    gently=st.booleans(),
)
def test_what_passes_can_be_braked_before_anything_is_touched(points, speed, turn, gently):
    seen = np.array(points)
    passed = permitted(Twist2(speed, turn), *points, gently=gently)
    if SETTINGS.footprint.distance(seen).min() > SETTINGS.margin_m and passed.twist != REST:
        assert stop(passed.twist, SETTINGS, seen) > 0.0
    assert abs(passed.twist.speed_mps) <= abs(speed) + 1e-12


@given(speed=st.floats(-0.4, 0.5), turn=st.floats(-1.3, 1.3), share=st.floats(0.5, 3.0))
def test_a_slowed_command_keeps_its_curvature(speed, turn, share):
    twist = permitted(Twist2(speed, turn), (share, 0.05), (-share, 0.0), (0.0, share)).twist
    assert twist.speed_mps * turn == pytest.approx(twist.yaw_rate_radps * speed, abs=1e-12)


def test_free_ground_lets_everything_pass():
    for twist in (AHEAD, BEHIND, Twist2(0.3, -1.0)):
        passed = permitted(twist, (3.0, 0.0), (0.0, 0.8), (-1.7, 0.0))
        assert passed.twist is twist and passed.action is GuardAction.PASSING and passed.reason == ""


def test_the_nearer_an_obstacle_the_slower_down_to_a_crawl_and_then_a_stop():
    speeds = [permitted(AHEAD, (FRONT_M + gap, 0.0)).twist.speed_mps for gap in (2.0, 0.4, 0.2, 0.07, 0.045, 0.035)]
    assert speeds[0] == 0.5 > speeds[1] > speeds[2] > speeds[3] == speeds[4] == SETTINGS.crawl_mps > speeds[5] == 0.0
    blocked = permitted(AHEAD, (FRONT_M + 0.035, 0.0))
    assert blocked.twist == REST and blocked.action is GuardAction.HOLDING and blocked.nearest_m == 0.0
    assert permitted(AHEAD, (FRONT_M + 0.07, 0.0)).nearest_m == pytest.approx(0.01, abs=1e-3)


def test_braking_at_the_last_moment_lets_more_pass_than_approaching_gently():
    gentle = permitted(AHEAD, (FRONT_M + 0.4, 0.0))
    last = permitted(AHEAD, (FRONT_M + 0.4, 0.0), gently=False)
    assert gentle.action is GuardAction.SLOWING and gentle.twist.speed_mps == pytest.approx(0.34)
    assert last.action is GuardAction.PASSING


def test_what_is_beside_the_robot_does_not_stop_it_going_straight_but_does_stop_its_turn():
    beside = ((0.0, 0.30), (0.3, 0.30))
    assert permitted(AHEAD, *beside).twist == AHEAD
    assert permitted(Twist2(0.0, 1.0), *beside).twist.yaw_rate_radps < 0.5


def test_a_robot_with_something_within_its_margin_may_back_off_slowly_and_not_approach():
    near = (FRONT_M + 0.03, 0.0)
    away = permitted(BEHIND, near)
    assert away.twist.speed_mps == pytest.approx(-SETTINGS.crawl_mps) and away.action is GuardAction.CRAWLING
    assert permitted(AHEAD, near).twist == REST
    assert permitted(BEHIND, near, (-FRONT_M - 0.01, 0.0)).twist == REST


def test_it_may_crawl_along_what_is_beside_it_within_the_margin():
    side = SETTINGS.footprint.half_width_m + 0.03
    both_sides = [(x, sign * side) for x in (-0.6, -0.3, 0.0, 0.3, 0.6) for sign in (-1.0, 1.0)]
    passed = permitted(AHEAD, *both_sides)
    assert passed.twist == Twist2(SETTINGS.crawl_mps, 0.0) and passed.action is GuardAction.CRAWLING
    assert permitted(Twist2(0.2, 0.6), *both_sides).twist == REST


def test_what_touches_already_must_be_left_unless_a_person_steers():
    side = SETTINGS.footprint.half_width_m - 0.002
    touching = [(x, side) for x in (-0.2, 0.0, 0.2)]
    assert permitted(AHEAD, *touching).twist == REST
    assert permitted(AHEAD, *touching, attended=True).twist == Twist2(SETTINGS.crawl_mps, 0.0)
    deeper = permitted(Twist2(0.2, -0.6), (FRONT_M - 0.01, -0.1), attended=True)
    assert deeper.twist == REST


def test_an_approach_ends_and_does_not_take_forever():
    gap, time_s = 0.5, 0.0
    while time_s < 4.0:
        gap -= permitted(AHEAD, (FRONT_M + gap, 0.0)).twist.speed_mps / 30.0
        time_s += 1.0 / 30.0
    assert SETTINGS.tight_margin_m <= gap < 0.04


def test_to_stand_needs_no_scan():
    assert CollisionGuard(SETTINGS).permitted(REST, NOW_NS).action is GuardAction.PASSING


def test_without_a_scan_the_robot_stands_and_says_so():
    passed = CollisionGuard(SETTINGS).permitted(AHEAD, NOW_NS)
    assert passed.twist == REST and passed.action is GuardAction.BLIND and passed.reason == "no scan yet"


def test_a_scan_becomes_points_at_their_place():
    guard = CollisionGuard(SETTINGS)
    guard.add_odometry(odometry(0.99))
    guard.add_scan(scan(NOW_NS - 10**8, ranges_of([(FRONT_M + 0.2, 0.0)], SETTINGS.lidar)))
    passed = guard.permitted(AHEAD, NOW_NS)
    assert passed.nearest_m == pytest.approx(0.2 - SETTINGS.margin_m, abs=1e-3)


@pytest.mark.parametrize("rpy", [(math.pi, 0.0, 0.0), (0.0, 0.3, 0.0)])
def test_a_lidar_that_is_not_level_is_refused_by_name(rpy):
    lidar = ROBOT.lidar.model_copy(update={"rpy_rad": rpy})
    with pytest.raises(ValueError, match="level lidar"):
        GuardSettings.from_robot(ROBOT.model_copy(update={"lidar": lidar}))
