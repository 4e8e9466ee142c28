from itertools import pairwise

import pytest

from nmpc_layers.drive_limits import DriveLimits
from nmpc_layers.stop_ramp import StopRamp
from tracked_types import Twist2

PERIOD_S = 1.0 / 30.0


@pytest.fixture
def limits(robot):
    return DriveLimits.from_robot(robot)


def test_holds_then_brakes_within_the_limits_to_exactly_zero(limits):
    ramp = StopRamp(limits, PERIOD_S, hold_s=0.1)
    ramp.accept(Twist2(-0.4, 1.2))
    commands = [ramp.next() for _ in range(30)]
    assert commands[:3] == [Twist2(-0.4, 1.2)] * 3
    assert commands[-1] == Twist2(0.0, 0.0)
    for before, after in pairwise(commands):
        assert abs(after.speed_mps - before.speed_mps) <= limits.braking_mps2 * PERIOD_S + 1e-12
        assert abs(after.yaw_rate_radps - before.yaw_rate_radps) <= limits.yaw_acceleration_radps2 * PERIOD_S + 1e-12
        assert abs(after.speed_mps) <= abs(before.speed_mps) and after.speed_mps <= 0.0


def test_without_hold_it_brakes_at_once(limits):
    ramp = StopRamp(limits, PERIOD_S, hold_s=0.0)
    ramp.accept(Twist2(0.3, 0.0))
    assert ramp.next().speed_mps == pytest.approx(0.3 - limits.braking_mps2 * PERIOD_S)


def test_a_good_command_renews_the_hold(limits):
    ramp = StopRamp(limits, PERIOD_S, hold_s=PERIOD_S)
    for _ in range(3):
        ramp.accept(Twist2(0.3, 0.0))
        assert ramp.next() == Twist2(0.3, 0.0)


def test_nothing_accepted_is_standstill(limits):
    assert StopRamp(limits, PERIOD_S, hold_s=0.1).next() == Twist2(0.0, 0.0)
