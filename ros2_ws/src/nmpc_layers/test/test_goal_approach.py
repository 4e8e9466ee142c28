from dataclasses import replace

import pytest

from nmpc_layers.goal_approach import GoalApproach, Phase, resting_pose
from nmpc_layers.upper_settings import UpperSettings
from tracked_types import Pose2, to_nanoseconds


@pytest.fixture
def approach(robot):
    return GoalApproach(UpperSettings.from_robot(robot).approach)


def follow(approach, given, odometry):
    return approach.reference(given, odometry, odometry.stamp_ns, 2.0)


def test_moving_reference_is_left_alone(approach, straight, odometry_at):
    given = straight(1.0)
    assert follow(approach, given, odometry_at(1.0)) is given
    assert approach.phase is Phase.FOLLOWING


def test_robot_at_the_goal_is_held_where_it_stands(approach, resting, odometry_at):
    held = follow(approach, resting(1.0), odometry_at(1.0, x=0.004))
    assert approach.phase is Phase.PARKED
    assert held.states[0, 0] == 0.004 and not held.inputs.any()


def test_sideways_offset_gets_a_manoeuvre_with_inputs_of_its_own(approach, resting, odometry_at):
    way = follow(approach, resting(1.0), odometry_at(1.0, y=0.05))
    assert approach.phase is Phase.APPROACHING
    assert way.inputs.any() and way.states[-1] == pytest.approx([0.0, 0.0, 0.0], abs=1e-9)


def test_manoeuvre_waits_until_the_robot_rests(approach, resting, odometry_at):
    given = resting(1.0)
    assert follow(approach, given, odometry_at(1.0, y=0.05, speed=0.2)) is given
    assert approach.phase is Phase.ARRIVING
    follow(approach, resting(1.2), odometry_at(1.2, y=0.05))
    assert approach.phase is Phase.APPROACHING


def test_robot_that_never_rests_is_not_waited_for_forever(approach, resting, odometry_at):
    for step in range(12):
        follow(approach, resting(1.0 + 0.2 * step), odometry_at(1.0 + 0.2 * step, y=0.05, speed=0.2))
    assert approach.phase is Phase.APPROACHING


def test_manoeuvre_is_kept_until_it_is_over(approach, resting, odometry_at):
    way = follow(approach, resting(1.0), odometry_at(1.0, x=0.05))
    assert follow(approach, resting(1.2), odometry_at(1.2, x=0.05)) is way


def test_attempts_are_limited_then_the_robot_stands(approach, resting, odometry_at):
    now_s = 1.0
    while approach.phase is not Phase.GAVE_UP and now_s < 600.0:
        held = follow(approach, resting(now_s), odometry_at(now_s, y=0.012))
        now_s += 0.2
    assert approach.phase is Phase.GAVE_UP and not held.inputs.any()


def test_robot_pushed_off_its_goal_returns(approach, resting, odometry_at):
    follow(approach, resting(1.0), odometry_at(1.0))
    follow(approach, resting(1.2), odometry_at(1.2, x=0.012))
    assert approach.phase is Phase.PARKED, "within the hysteresis"
    follow(approach, resting(1.4), odometry_at(1.4, x=0.1))
    assert approach.phase is Phase.APPROACHING


def test_robot_pushed_off_its_manoeuvre_gets_another(approach, resting, odometry_at):
    way = follow(approach, resting(1.0), odometry_at(1.0, x=-0.05))
    assert follow(approach, resting(1.2), odometry_at(1.2, x=-0.5)) is not way


def test_another_goal_starts_over(approach, resting, odometry_at):
    follow(approach, resting(1.0), odometry_at(1.0))
    follow(approach, resting(1.2, x=0.2), odometry_at(1.2))
    assert approach.phase is Phase.APPROACHING


def test_reference_that_starts_within_the_horizon_is_not_at_rest(resting):
    given = resting(1.0)
    moving = given.inputs.copy()
    moving[30:, 0] = 0.1
    states = given.states.copy()
    states[30:, 0] = 0.1
    started = replace(given, inputs=moving, states=states)
    stamp = to_nanoseconds(1.0)
    assert resting_pose(started, stamp, stamp, 2.0) is None
    assert resting_pose(given, stamp, stamp, 2.0) == Pose2(0.0, 0.0, 0.0)
