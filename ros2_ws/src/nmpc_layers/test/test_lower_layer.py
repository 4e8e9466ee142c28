import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from nmpc_layers import LowerLayer, LowerSettings
from tracked_types import PeriodGrid, Twist2, VelocityCommand, to_nanoseconds

GRID = PeriodGrid(60)


@pytest.fixture(scope="module")
def layer_with(robot):
    return lambda **tuning: LowerLayer(LowerSettings.from_robot(robot, **tuning))


def drive(layer, odometry_at, slip_at, straight, start, stop, plans=True, slips=True, **where):
    """Outputs by odometry index (60 Hz), the plan renewed at 5 Hz, the slip with each odometry."""
    outputs = {}
    for index in range(start, stop):
        time_s, stamp_ns = index / 60.0, GRID.stamp_ns(index)
        if plans and index % 12 == 0:
            layer.set_plan(straight(time_s))
        if slips:
            layer.set_slip(replace(slip_at(time_s), stamp_ns=stamp_ns))
        output = layer.update(replace(odometry_at(time_s, **where), stamp_ns=stamp_ns))
        if output is not None:
            outputs[index] = output
    return outputs


def test_ticks_at_control_instants_with_the_stamp_it_answers(layer_with, odometry_at, slip_at, straight):
    outputs = drive(layer_with(), odometry_at, slip_at, straight, 12, 20)
    assert list(outputs) == [12, 14, 16, 18]
    assert outputs[14].command.stamp_ns == GRID.stamp_ns(14)
    assert outputs[14].status.ok and outputs[14].status.layer == "lower"


def test_before_the_first_plan_there_is_no_command(layer_with, odometry_at, slip_at, straight):
    output = drive(layer_with(), odometry_at, slip_at, straight, 12, 14, plans=False)[12]
    assert output.command is None and output.status.reason == "no plan yet"


def test_lock_step_waits_for_the_plan_that_is_due(layer_with, straight):
    layer = layer_with(pipeline_latency_s=0.1)
    assert not layer.waits_for_plan(to_nanoseconds(0.3) - 1), "none is made at time zero"
    assert layer.waits_for_plan(to_nanoseconds(0.3))
    layer.set_plan(straight(0.2))
    assert not layer.waits_for_plan(to_nanoseconds(0.3))
    assert not layer.waits_for_plan(to_nanoseconds(0.5) - 1)
    assert layer.waits_for_plan(to_nanoseconds(0.5))
    layer.set_plan(straight(0.4))
    assert not layer.waits_for_plan(to_nanoseconds(0.5))


def test_lock_step_without_latency_waits_for_the_plan_of_the_same_instant(layer_with, straight):
    layer = layer_with(pipeline_latency_s=0.0)
    layer.set_plan(straight(0.2))
    assert layer.waits_for_plan(to_nanoseconds(0.4))
    assert not layer.waits_for_plan(to_nanoseconds(0.4) - 1)


def test_lock_step_does_not_wait_across_a_reset_of_the_clock(layer_with, odometry_at, slip_at, straight):
    layer = layer_with()
    drive(layer, odometry_at, slip_at, straight, 600, 620)
    assert not layer.waits_for_plan(to_nanoseconds(0.5))
    assert not layer.waits_for_slip(to_nanoseconds(0.5))


def test_lock_step_waits_for_the_slip_of_the_same_instant(layer_with, slip_at):
    layer = layer_with()
    assert not layer.waits_for_slip(to_nanoseconds(1.0)), "none has ever come"
    layer.set_slip(slip_at(1.0))
    assert not layer.waits_for_slip(to_nanoseconds(1.0))
    assert layer.waits_for_slip(to_nanoseconds(1.02))
    assert not layer_with(slip_compensation=False).waits_for_slip(to_nanoseconds(1.0))


def test_late_tick_uses_the_slip_of_its_own_instant(layer_with, odometry_at, slip_at, straight):
    outputs = []
    for stamps in ((1.0,), (1.0, 1.0 + 1.0 / 60.0, 1.0 + 2.0 / 60.0)):
        layer = layer_with()
        layer.set_plan(straight(0.9))
        for index, stamp_s in enumerate(stamps):
            layer.set_slip(replace(slip_at(stamp_s), yaw_rate_radps=-0.2 * index))
        outputs.append(layer.update(odometry_at(1.0)).command)
    assert outputs[0] == outputs[1]


def test_missing_plans_ramp_down_within_the_limits_and_it_recovers(layer_with, odometry_at, slip_at, straight, robot):
    layer = layer_with()
    drive(layer, odometry_at, slip_at, straight, 12, 36, x=0.1, speed=0.3)
    outputs = drive(layer, odometry_at, slip_at, straight, 36, 120, plans=False, x=0.1, speed=0.3)
    reasons = {index: output.status.reason for index, output in outputs.items() if not output.status.ok}
    assert min(reasons) == 62 and "old" in reasons[62]
    speeds = [outputs[index].command.twist.speed_mps for index in sorted(reasons)]
    assert speeds[-1] == 0.0 and speeds[0] > 0.1
    assert np.abs(np.diff(speeds)).max() <= robot.limits.braking_mps2 / 30.0 + 1e-9
    assert all(output.command is not None for output in outputs.values())
    recovered = drive(layer, odometry_at, slip_at, straight, 120, 123)
    assert recovered[120].status.ok and recovered[120].command.twist.speed_mps > 0.0


def test_plan_ahead_of_the_odometry_is_missing(layer_with, odometry_at, slip_at, straight):
    layer = layer_with()
    layer.set_plan(straight(9.0))
    assert "ahead" in layer.update(odometry_at(0.2)).status.reason


def test_older_plan_does_not_replace_a_newer_one(layer_with, straight):
    layer = layer_with()
    layer.set_plan(straight(0.4))
    layer.set_plan(straight(0.2))
    assert not layer.waits_for_plan(to_nanoseconds(0.5))


@pytest.mark.parametrize("slips", [False, True])
def test_missing_slip_is_said_and_driven_without(layer_with, odometry_at, slip_at, straight, slips):
    layer = layer_with()
    if slips:
        layer.set_slip(slip_at(0.0, yaw_rate=-0.4))
    output = drive(layer, odometry_at, slip_at, straight, 12, 13, slips=False, x=0.06, speed=0.3)[12]
    assert not output.status.ok and "not compensated" in output.status.reason
    assert output.prediction is not None and abs(output.command.twist.yaw_rate_radps) < 0.01


@pytest.mark.parametrize("method", ["thesis", "improved"])
def test_measured_yaw_slip_is_countered(layer_with, odometry_at, slip_at, straight, method):
    layer = layer_with(method=method)
    layer.set_plan(straight(0.2))
    layer.set_slip(slip_at(0.2, yaw_rate=-0.3))
    command = layer.update(odometry_at(0.2, x=0.06, speed=0.3, yaw_rate=-0.3)).command
    assert command.twist.yaw_rate_radps > 0.05


def test_improved_target_moves_with_the_slip_to_full_compensation(robot, odometry_at, slip_at, straight):
    """In steady motion along the plan the belts turn against the slip at exactly its rate."""
    layer = LowerLayer(replace(LowerSettings.from_robot(robot), yaw_ratio=1.0))
    layer.set_plan(straight(0.2))
    layer.set_slip(slip_at(0.2, yaw_rate=-0.3))
    for index in range(12):
        layer.set_sent(VelocityCommand(GRID.stamp_ns(index), Twist2(0.3, 0.3)))
    command = layer.update(odometry_at(0.2, x=0.06, speed=0.3, yaw_rate=0.0)).command
    assert command.twist.yaw_rate_radps == pytest.approx(0.3, abs=1e-3)
    assert command.twist.speed_mps == pytest.approx(0.3, abs=1e-3)


def test_standstill_slip_is_no_slip(layer_with, odometry_at, slip_at, resting):
    layer = layer_with()
    layer.set_plan(resting(0.2))
    layer.set_slip(slip_at(0.2, known=False))
    command = layer.update(odometry_at(0.2)).command
    assert command.twist.speed_mps == pytest.approx(0.0, abs=1e-9)
    assert command.twist.yaw_rate_radps == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("method", ["thesis", "improved"])
def test_prediction_starts_where_the_command_takes_effect(layer_with, odometry_at, slip_at, straight, method, robot):
    layer = layer_with(method=method)
    for index in range(12):
        layer.set_sent(VelocityCommand(GRID.stamp_ns(index), Twist2(0.3, 0.0)))
    prediction = drive(layer, odometry_at, slip_at, straight, 12, 13, x=0.06, speed=0.3)[12].prediction
    delay_s = robot.control.transport_delay_s if method == "improved" else 0.0
    assert prediction.times_s[0] == pytest.approx(delay_s)
    assert prediction.states[0, 0] == pytest.approx(0.06 + 0.3 * delay_s, abs=1e-9)


@pytest.mark.parametrize("method", ["thesis", "improved"])
@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_heading_is_regulated_across_the_wrap(layer_with, odometry_at, slip_at, resting, method, side):
    layer = layer_with(method=method)
    layer.set_plan(resting(0.2, yaw=side * (math.pi - 0.05)))
    layer.set_slip(slip_at(0.2, known=False))
    command = layer.update(odometry_at(0.2, yaw=-side * (math.pi - 0.05))).command
    assert 0.0 < -side * command.twist.yaw_rate_radps < 1.3


def test_track_limits_are_kept_from_one_command_to_the_next(layer_with, odometry_at, slip_at, straight, robot):
    layer = layer_with(constraints="tracks")
    outputs = drive(layer, odometry_at, slip_at, straight, 12, 60, y=0.1, yaw=-0.5)
    twists = [Twist2(0.0, 0.0)] + [output.command.twist for output in outputs.values()]
    assert all(output.status.ok for output in outputs.values())
    for before, after in pairwise(twists):
        assert abs(after.speed_mps - before.speed_mps) <= robot.limits.braking_mps2 / 30.0 + 1e-6
        assert abs(after.yaw_rate_radps - before.yaw_rate_radps) <= robot.limits.yaw_acceleration_radps2 / 30.0 + 1e-6


@pytest.mark.parametrize("value", [math.nan, math.inf, 1e250])
def test_bad_odometry_ramps_down_and_is_survived(layer_with, odometry_at, slip_at, straight, spoiled, value):
    layer = layer_with(hold_s=0.0)
    drive(layer, odometry_at, slip_at, straight, 12, 18, x=0.1, speed=0.3)
    output = layer.update(spoiled(odometry_at(0.3), x_m=value))
    assert not output.status.ok and output.prediction is None
    assert math.isfinite(output.command.twist.speed_mps)
    assert drive(layer, odometry_at, slip_at, straight, 24, 25)[24].status.ok


def test_bad_inputs_are_ignored(layer_with, odometry_at, slip_at, straight):
    layer = layer_with()
    plan = straight(0.2)
    layer.set_plan(plan)
    layer.set_slip(slip_at(0.2))
    spoiled = straight(0.2)
    spoiled.inputs[4, 0] = math.inf
    layer.set_plan(spoiled)
    layer.set_slip(slip_at(0.2, yaw_rate=math.nan))
    layer.set_sent(VelocityCommand(to_nanoseconds(0.1), Twist2(math.nan, 0.0)))
    assert layer.update(odometry_at(0.2)).status.ok


def test_odometry_out_of_order_is_ignored_and_counted(layer_with, odometry_at, straight):
    layer = layer_with()
    layer.set_plan(straight(0.4))
    assert layer.update(odometry_at(0.4)) is not None
    assert layer.update(odometry_at(0.4)) is None and layer.update(odometry_at(0.3)) is None
    assert layer.ignored_odometry == 2


def test_clock_that_jumps_back_starts_over(layer_with, odometry_at, slip_at, straight):
    layer = layer_with()
    drive(layer, odometry_at, slip_at, straight, 600, 620, speed=0.3)
    output = layer.update(odometry_at(1.0))
    assert output.command is None and output.status.reason == "no plan yet"
    assert drive(layer, odometry_at, slip_at, straight, 72, 73)[72].status.ok


def test_plan_of_another_time_does_not_keep_out_those_of_the_present(layer_with, odometry_at, slip_at, straight):
    layer = layer_with()
    layer.set_plan(straight(600.0))
    assert drive(layer, odometry_at, slip_at, straight, 72, 73)[72].status.ok


@settings(max_examples=40, derandomize=True, deadline=None)
@given(numbers=st.lists(st.floats(), min_size=5, max_size=5), slip=st.floats())
def test_any_input_gives_a_bounded_command_and_no_exception(layer_with, odometry_at, slip_at, straight, numbers, slip):
    layer = layer_with()
    layer.set_plan(straight(0.2))
    layer.set_slip(slip_at(0.2, yaw_rate=slip))
    command = layer.update(odometry_at(0.2, *numbers)).command
    assert -0.4 <= command.twist.speed_mps <= 0.5 and abs(command.twist.yaw_rate_radps) <= 1.3
