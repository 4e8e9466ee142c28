import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tracked_description import load_robot
from tracked_safety.collision_guard import CollisionGuard, GuardSettings
from tracked_types import Pose2, Twist2

ROBOT = load_robot()
SETTINGS = GuardSettings.from_robot(ROBOT)
REST, AHEAD = Twist2(0.0, 0.0), Twist2(0.5, 0.0)
NOW_NS = 10**9


def guard(*points, settings=SETTINGS, age_s=0.0):
    made = CollisionGuard(settings)
    made.set_scan(np.array(points, float).reshape(-1, 2), NOW_NS - round(age_s * 1e9))
    return made


def stop(twist, settings, points, obstacle_speed=0.0):
    """Least distance of the footprint from the points while the robot obeys, then brakes to rest."""
    pose, speed, time_s, least = Pose2(0.0, 0.0, 0.0), 1.0, 0.0, math.inf
    pace = max(abs(twist.speed_mps), 0.5 * abs(twist.yaw_rate_radps))
    while speed > 0.0:
        least = min(least, settings.footprint.distance(pose.inverse().transform(points)).min())
        if time_s > settings.reaction_s + settings.delay_s:
            speed -= settings.braking_mps2 * 0.005 / pace
        pose = pose.compose(Pose2(0.005 * speed * twist.speed_mps, 0.0, 0.005 * speed * twist.yaw_rate_radps))
        time_s += 0.005
    return least


@settings(max_examples=300, deadline=None)
@given(
    points=st.lists(st.tuples(st.floats(-2.0, 2.0), st.floats(-2.0, 2.0)), min_size=1, max_size=6),
    speed=st.floats(-0.4, 0.5),
    turn=st.floats(-1.3, 1.3),
)
def test_what_passes_can_be_braked_before_anything_is_touched(points, speed, turn):
    scan = np.array(points)
    passed = guard(*points).permitted(Twist2(speed, turn), REST, NOW_NS)
    distance = SETTINGS.footprint.distance(scan).min()
    if distance > SETTINGS.margin_m and passed.twist != REST:
        assert stop(passed.twist, SETTINGS, scan) > 0.0
    assert abs(passed.twist.speed_mps) <= abs(speed) + 1e-12


@given(speed=st.floats(-0.4, 0.5), turn=st.floats(-1.3, 1.3), share=st.floats(0.5, 3.0))
def test_a_slowed_command_keeps_its_curvature(speed, turn, share):
    twist = guard((share, 0.05), (-share, 0.0), (0.0, share)).permitted(Twist2(speed, turn), REST, NOW_NS).twist
    assert twist.speed_mps * turn == pytest.approx(twist.yaw_rate_radps * speed, abs=1e-12)


def test_free_ground_lets_everything_pass():
    assert guard((3.0, 0.0), (0.0, 0.6), (-0.7, 0.0)).permitted(AHEAD, REST, NOW_NS) == guard().permitted(
        AHEAD, REST, NOW_NS
    )


def test_the_nearer_an_obstacle_the_slower_up_to_a_stop():
    speeds = [guard((0.34 + gap, 0.0)).permitted(AHEAD, AHEAD, NOW_NS).twist.speed_mps for gap in (2.0, 0.4, 0.2, 0.07)]
    assert speeds[0] == 0.5 > speeds[1] > speeds[2] > speeds[3]
    blocked = guard((0.34 + 0.061, 0.0)).permitted(AHEAD, AHEAD, NOW_NS)
    assert blocked.twist == REST and "ahead" in blocked.reason


def test_what_is_beside_the_robot_does_not_stop_it_going_straight_but_does_stop_its_turn():
    beside = guard((0.0, 0.30), (0.3, 0.30))
    assert beside.permitted(AHEAD, REST, NOW_NS).twist == AHEAD
    assert beside.permitted(Twist2(0.0, 1.0), REST, NOW_NS).twist.yaw_rate_radps < 0.5


def test_a_robot_that_touches_something_may_back_off_slowly_and_nothing_else():
    touching = guard((0.37, 0.0))
    away = touching.permitted(Twist2(-0.4, 0.0), REST, NOW_NS)
    assert away.twist.speed_mps == pytest.approx(-SETTINGS.escape_mps)
    assert touching.permitted(AHEAD, REST, NOW_NS).twist == REST
    assert guard((0.37, 0.0), (-0.36, 0.0)).permitted(Twist2(-0.4, 0.0), REST, NOW_NS).twist == REST


@pytest.mark.parametrize("age_s", [0.31, -0.4, 5.0])
def test_without_a_fresh_scan_the_robot_stands(age_s):
    passed = guard(age_s=age_s).permitted(AHEAD, REST, NOW_NS)
    assert passed.twist == REST and "old" in passed.reason
    assert "no scan" in CollisionGuard(SETTINGS).permitted(AHEAD, REST, NOW_NS).reason


def test_to_stand_needs_no_scan():
    assert CollisionGuard(SETTINGS).permitted(REST, AHEAD, NOW_NS).reason == ""


def test_a_scan_of_a_moment_ago_is_carried_on_by_the_robots_motion():
    old = guard((1.0, 0.0), age_s=0.2).permitted(AHEAD, AHEAD, NOW_NS)
    new = guard((0.9, 0.0)).permitted(AHEAD, AHEAD, NOW_NS)
    assert old.twist.speed_mps == pytest.approx(new.twist.speed_mps)


def test_scans_out_of_order_are_ignored_and_a_jump_of_the_clock_asks_for_a_new_one():
    made = guard((0.5, 0.0))
    made.set_scan(np.zeros((0, 2)), NOW_NS - 1)
    assert made.permitted(AHEAD, REST, NOW_NS).twist != AHEAD
    made.forget()
    assert "no scan" in made.permitted(AHEAD, REST, NOW_NS).reason


def test_points_that_are_not_finite_are_refused():
    with pytest.raises(ValueError, match="finite"):
        guard((np.nan, 0.0))
