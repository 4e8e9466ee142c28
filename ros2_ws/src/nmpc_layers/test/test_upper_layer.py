import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from nmpc_layers import UpperLayer, UpperSettings
from tracked_types import PeriodGrid, Twist2, VelocityCommand, angle_difference, to_nanoseconds

GRID = PeriodGrid(60)


@pytest.fixture(scope="module")
def layer_with(robot):
    return lambda **tuning: UpperLayer(UpperSettings.from_robot(robot, **tuning))


def drive(layer, odometry_at, straight, start, stop, reference=True, **where):
    """Outputs by odometry index (60 Hz) from ``start`` to ``stop``, the reference renewed at 5 Hz."""
    outputs = {}
    for index in range(start, stop):
        time_s = index / 60.0
        if reference and index % 12 == 0:
            layer.set_reference(straight(time_s))
        output = layer.update(replace(odometry_at(time_s, **where), stamp_ns=GRID.stamp_ns(index)))
        if output is not None:
            outputs[index] = output
    return outputs


def test_plan_is_held_back_by_the_latency_and_stamped_when_it_was_made(layer_with, odometry_at, straight):
    outputs = drive(layer_with(pipeline_latency_s=0.1), odometry_at, straight, 12, 40)
    plans = {index: output.trajectory for index, output in outputs.items() if output.trajectory}
    assert list(plans) == [18, 30]
    assert plans[18].stamp_ns == to_nanoseconds(0.2)
    assert [index for index, output in outputs.items() if output.status] == [12, 24, 36]


def test_latency_between_instants_ends_with_the_next_odometry(layer_with, odometry_at, straight):
    outputs = drive(layer_with(pipeline_latency_s=0.09), odometry_at, straight, 12, 24)
    assert [index for index, output in outputs.items() if output.trajectory] == [18]


def test_without_latency_the_plan_comes_at_once(layer_with, odometry_at, straight):
    outputs = drive(layer_with(pipeline_latency_s=0.0), odometry_at, straight, 12, 24)
    assert outputs[12].trajectory is not None


def test_latency_longer_than_a_period_keeps_every_plan(layer_with, odometry_at, straight):
    outputs = drive(layer_with(pipeline_latency_s=0.5), odometry_at, straight, 12, 100)
    stamps = [output.trajectory.stamp_ns for output in outputs.values() if output.trajectory]
    assert stamps == [to_nanoseconds(0.2 * count) for count in range(1, 6)]


def test_double_layers_publish_no_command(layer_with, odometry_at, straight):
    outputs = drive(layer_with(), odometry_at, straight, 12, 60)
    assert all(output.command is None for output in outputs.values())


def test_single_layer_commands_at_control_instants_once_a_plan_is_effective(layer_with, odometry_at, straight):
    outputs = drive(layer_with(layers="single"), odometry_at, straight, 12, 40)
    commands = {index: output.command for index, output in outputs.items() if output.command}
    assert list(commands) == list(range(18, 40, 2))
    assert commands[20].stamp_ns == GRID.stamp_ns(20)
    assert len({commands[index].twist for index in range(18, 30, 2)}) == 1


@pytest.mark.parametrize(("predict_latency", "ahead_s"), [(False, 0.0), (True, 0.14)])
def test_single_layer_may_plan_from_where_the_plan_takes_effect(
    layer_with, odometry_at, straight, predict_latency, ahead_s
):
    layer = layer_with(layers="single", predict_latency=predict_latency)
    for index in range(12):
        layer.set_sent(VelocityCommand(GRID.stamp_ns(index), Twist2(0.3, 0.0)))
    outputs = drive(layer, odometry_at, straight, 12, 20, x=0.06, speed=0.3)
    plan = outputs[18].trajectory
    assert plan.times_s[0] == pytest.approx(ahead_s)
    assert plan.states[0, 0] == pytest.approx(0.06 + 0.3 * ahead_s, abs=1e-6)


def test_reference_driven_without_error_needs_its_own_inputs(layer_with, odometry_at, straight):
    layer = layer_with(pipeline_latency_s=0.0, layers="single")
    layer.set_reference(straight(0.2))
    output = layer.update(odometry_at(0.2, x=0.06, speed=0.3))
    assert output.command.twist.speed_mps == pytest.approx(0.3, abs=1e-6)
    assert output.command.twist.yaw_rate_radps == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("method", ["thesis", "improved"])
def test_heading_is_regulated_across_the_wrap(layer_with, odometry_at, straight, method):
    layer = layer_with(method=method, pipeline_latency_s=0.0)
    given = straight(0.2)
    backwards = replace(
        given, states=np.column_stack([-given.states[:, 0], given.states[:, 1], given.states[:, 0] * 0])
    )
    backwards.states[:, 2] = math.pi - 0.02
    layer.set_reference(backwards)
    plan = layer.update(odometry_at(0.2, x=-0.06, yaw=-math.pi + 0.02, speed=0.3)).trajectory
    turned = angle_difference(plan.states[:, 2], -math.pi + 0.02)
    assert np.all(np.abs(plan.states[:, 2]) <= math.pi)
    assert np.abs(turned).max() < 0.06 and turned[-1] < 0.0


def plan_while_turning(layer, odometry_at, straight, slip=None):
    if slip is not None:
        layer.set_slip(slip)
    return drive(layer, odometry_at, straight, 12, 13, speed=0.3, yaw_rate=0.5)[12].trajectory.states


def test_learnt_slide_moves_the_plan_outwards(layer_with, odometry_at, slip_at, straight):
    plain = plan_while_turning(layer_with(pipeline_latency_s=0.0), odometry_at, straight)
    sliding = replace(slip_at(0.2), slide_s=0.2)
    moved = plan_while_turning(layer_with(pipeline_latency_s=0.0), odometry_at, straight, sliding)
    assert moved[0, 1] < plain[0, 1] - 1e-4


@pytest.mark.parametrize(
    ("tuning", "change"),
    [
        ({}, {"slide_s": math.nan}),
        ({}, {"stamp_ns": to_nanoseconds(5.0)}),
        ({"method": "thesis"}, {}),
        ({"slide_compensation": False}, {}),
    ],
)
def test_slide_that_is_unusable_or_not_wanted_changes_nothing(
    layer_with, odometry_at, slip_at, straight, tuning, change
):
    plain = plan_while_turning(layer_with(pipeline_latency_s=0.0, **tuning), odometry_at, straight)
    slip = replace(slip_at(0.2), **{"slide_s": 0.2, **change})
    assert np.array_equal(
        plan_while_turning(layer_with(pipeline_latency_s=0.0, **tuning), odometry_at, straight, slip), plain
    )


def test_lock_step_plans_with_the_slide_of_the_same_instant(layer_with, odometry_at, slip_at, straight):
    layer = layer_with()
    drive(layer, odometry_at, straight, 12, 22)
    assert not layer.waits_for_slip(to_nanoseconds(0.4)), "none has ever come"
    layer.set_slip(slip_at(0.38))
    assert layer.waits_for_slip(to_nanoseconds(0.4))
    assert not layer.waits_for_slip(to_nanoseconds(0.38)), "no plan is due"
    layer.set_slip(slip_at(0.4))
    assert not layer.waits_for_slip(to_nanoseconds(0.4))


def test_no_reference_is_said_and_nothing_planned(layer_with, odometry_at, straight):
    outputs = drive(layer_with(), odometry_at, straight, 12, 40, reference=False)
    assert all(output.trajectory is None and not output.status.ok for output in outputs.values())
    assert outputs[12].status.reason == "no reference yet"


def test_stale_reference_stops_within_the_limits_and_recovers(layer_with, odometry_at, straight, robot):
    layer = layer_with(layers="single")
    drive(layer, odometry_at, straight, 0, 30, speed=0.3)
    outputs = drive(layer, odometry_at, straight, 30, 130, reference=False, speed=0.3)
    failed = [output.status for output in outputs.values() if output.status and not output.status.ok]
    assert failed and "old" in failed[0].reason
    speeds = [output.command.twist.speed_mps for output in outputs.values() if output.command]
    assert speeds[-1] == 0.0 and max(speeds) > 0.2
    assert np.abs(np.diff(speeds)).max() <= robot.limits.braking_mps2 / 30.0 + 0.02
    outputs = drive(layer, odometry_at, straight, 132, 160)
    assert outputs[144].status.ok and outputs[158].command.twist.speed_mps > 0.1


def test_stale_reference_gives_the_lower_layer_a_plan_that_stops(layer_with, odometry_at, straight):
    layer = layer_with(pipeline_latency_s=0.0)
    drive(layer, odometry_at, straight, 12, 24)
    outputs = drive(layer, odometry_at, straight, 24, 80, reference=False, speed=0.3)
    plan = outputs[72].trajectory
    assert not outputs[72].status.ok
    assert plan.inputs[0, 0] == pytest.approx(0.3) and not plan.inputs[-1].any()
    assert 0.0 < plan.states[-1, 0] < 0.2


def test_reference_from_the_future_is_missing(layer_with, odometry_at, straight):
    layer = layer_with()
    layer.set_reference(straight(9.0))
    assert "ahead" in layer.update(odometry_at(0.2)).status.reason


def test_reference_that_rests_does_not_grow_old(layer_with, odometry_at, resting):
    layer = layer_with(pipeline_latency_s=0.0)
    layer.set_reference(resting(0.2))
    assert layer.update(odometry_at(60.2)).status.ok


def test_solver_that_gives_up_stops_the_robot_and_says_why(layer_with, odometry_at, straight):
    layer = layer_with(pipeline_latency_s=0.0)
    drive(layer, odometry_at, straight, 12, 24)
    given = straight(0.4)
    layer.set_reference(replace(given, states=given.states * 1e200))
    output = layer.update(odometry_at(0.4, speed=0.3))
    assert "non-finite" in output.status.reason
    assert not output.trajectory.inputs[-1].any()
    assert drive(layer, odometry_at, straight, 36, 37)[36].status.ok


@pytest.mark.parametrize("field", ["x_m", "y_m", "yaw_rad"])
@pytest.mark.parametrize("value", [math.nan, math.inf])
def test_bad_odometry_is_said_and_survived(layer_with, odometry_at, straight, spoiled, field, value):
    layer = layer_with(pipeline_latency_s=0.0)
    layer.set_reference(straight(0.2))
    output = layer.update(spoiled(odometry_at(0.2), **{field: value}))
    assert not output.status.ok and output.trajectory is None
    layer.set_reference(straight(0.4))
    assert layer.update(odometry_at(0.4)).status.ok


def test_reference_that_is_not_finite_is_ignored(layer_with, odometry_at, straight):
    layer = layer_with(pipeline_latency_s=0.0)
    layer.set_reference(straight(0.2))
    spoiled = straight(0.2)
    spoiled.states[3, 1] = math.nan
    layer.set_reference(spoiled)
    assert layer.update(odometry_at(0.2)).status.ok


def test_odometry_out_of_order_is_ignored_and_counted(layer_with, odometry_at, straight):
    layer = layer_with(pipeline_latency_s=0.0)
    layer.set_reference(straight(0.4))
    assert layer.update(odometry_at(0.4)).status.ok
    assert layer.update(odometry_at(0.4)) is None
    assert layer.update(odometry_at(0.2)) is None
    assert layer.ignored_odometry == 2


def test_lost_odometry_of_an_instant_is_made_up_for_by_the_next(layer_with, odometry_at, straight):
    layer = layer_with(pipeline_latency_s=0.0)
    layer.set_reference(straight(0.35))
    layer.update(odometry_at(0.35))
    assert layer.update(odometry_at(0.41)).trajectory.stamp_ns == to_nanoseconds(0.41)


def test_clock_that_jumps_back_starts_over(layer_with, odometry_at, straight):
    layer = layer_with()
    drive(layer, odometry_at, straight, 600, 640)
    output = layer.update(odometry_at(1.0))
    assert output.status.reason == "no reference yet" and output.trajectory is None
    assert drive(layer, odometry_at, straight, 72, 73)[72].status.ok


@settings(max_examples=40, derandomize=True, deadline=None)
@given(numbers=st.lists(st.floats(), min_size=5, max_size=5))
def test_any_odometry_gives_a_status_and_no_exception(layer_with, odometry_at, straight, numbers):
    layer = layer_with(pipeline_latency_s=0.0, layers="single", compile_solver=True)
    layer.set_reference(straight(0.2))
    output = layer.update(odometry_at(0.2, *numbers))
    assert output.status is not None
    if output.command is not None:
        assert abs(output.command.twist.speed_mps) <= 0.5
