import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from nmpc_layers.sent_commands import GroundModel, SentCommands, predict
from tracked_types import PeriodGrid, Pose2, Twist2, VelocityCommand, to_nanoseconds


def command(time_s, speed=0.0):
    return VelocityCommand(to_nanoseconds(time_s), Twist2(speed, 0.0))


def in_force(sent, start_s, end_s):
    return [
        (duration, twist.speed_mps) for duration, twist in sent.in_force(to_nanoseconds(start_s), to_nanoseconds(end_s))
    ]


def test_commands_act_a_transport_delay_after_their_stamp():
    sent = SentCommands(0.04)
    sent.add(command(1.0, 0.1))
    sent.add(command(1.033, 0.2))
    assert in_force(sent, 1.03, 1.08) == [
        (pytest.approx(0.01), 0.0),
        (pytest.approx(0.033), 0.1),
        (pytest.approx(0.007), 0.2),
    ]


def test_word_is_lacking_until_that_on_the_last_control_instant_has_come():
    control, sent = PeriodGrid(30), SentCommands(0.04)
    before, now = command(1.0 - 1.0 / 30.0, 0.1), to_nanoseconds(1.0)
    assert not sent.lacks_word(now, control), "commands have not begun"
    sent.add(before)
    assert sent.lacks_word(now, control) and sent.lacks_word_on_newest
    sent.confirm(command(1.0 - 2.0 / 30.0, 0.1))
    assert sent.lacks_word(now, control)
    sent.confirm(before)
    assert not sent.lacks_word(now, control) and not sent.lacks_word_on_newest
    assert sent.lacks_word(now + 1, control)


def test_answers_to_the_same_odometry_are_not_foreseen():
    sent = SentCommands(0.0)
    sent.add(command(0.9, 0.1))
    sent.add(command(1.0, 0.2))
    known = sent.in_force(to_nanoseconds(1.0), to_nanoseconds(1.1), before_ns=to_nanoseconds(1.0))
    assert [twist.speed_mps for _, twist in known] == [0.1]


def test_nothing_sent_is_standstill():
    assert in_force(SentCommands(0.04), 1.0, 1.04) == [(pytest.approx(0.04), 0.0)]


def test_empty_span_has_no_commands():
    assert in_force(SentCommands(0.0), 1.0, 1.0) == []


def test_word_of_the_arbiter_replaces_the_guess_of_equal_stamp():
    sent = SentCommands(0.0)
    sent.add(command(1.0, 0.5))
    sent.add(command(1.0, 0.05))
    assert in_force(sent, 1.0, 1.1) == [(pytest.approx(0.1), 0.05)]


def test_commands_out_of_order_are_sorted_in():
    sent = SentCommands(0.0)
    for time_s, speed in ((1.0, 0.1), (1.2, 0.3), (1.1, 0.2)):
        sent.add(command(time_s, speed))
    assert [speed for _, speed in in_force(sent, 1.0, 1.3)] == [0.1, 0.2, 0.3]


def test_memory_is_bounded_and_keeps_the_command_that_still_acts():
    sent = SentCommands(0.0)
    for index in range(1000):
        sent.add(command(index / 30.0, index / 1000.0))
    assert len(list(sent.in_force(0, to_nanoseconds(100.0)))) < 65
    sent.add(command(500.0, 0.4))
    assert in_force(sent, 499.0, 501.0) == [(pytest.approx(1.0), 0.999), (pytest.approx(1.0), 0.4)]


def test_clock_that_was_set_back_forgets_what_was_sent_in_another_time():
    sent = SentCommands(0.0)
    sent.add(command(500.0, 0.4))
    sent.add(command(1.0, 0.1))
    sent.add(command(1.1, 0.2))
    assert in_force(sent, 1.0, 1.2) == [(pytest.approx(0.1), 0.1), (pytest.approx(0.1), 0.2)]


@pytest.mark.parametrize("value", [math.nan, math.inf])
def test_command_that_is_not_finite_is_ignored(value):
    sent = SentCommands(0.0)
    sent.add(command(1.0, 0.1))
    sent.add(command(1.0, value))
    assert sent.latest_before(to_nanoseconds(2.0)).speed_mps == 0.1


def test_latest_before_leaves_out_the_present():
    sent = SentCommands(0.0)
    sent.add(command(1.0, 0.1))
    assert sent.latest_before(to_nanoseconds(1.0)) == Twist2(0.0, 0.0)


@settings(max_examples=100, derandomize=True)
@given(stamps=st.lists(st.floats(0.0, 1.9), max_size=8), start=st.floats(0.0, 1.0), length=st.floats(0.0, 1.0))
def test_spans_cover_exactly_the_time_asked_for(stamps, start, length):
    sent = SentCommands(0.04)
    for stamp in stamps:
        sent.add(command(stamp, 0.1))
    spans = in_force(sent, start, start + length)
    assert sum(duration for duration, _ in spans) == pytest.approx(length, abs=2e-9)
    assert all(duration > 0.0 for duration, _ in spans)


@pytest.mark.parametrize("yaw", [math.nan, math.inf])
def test_prediction_from_bad_numbers_stays_bad_without_raising(yaw):
    pose, _ = predict(Pose2(0.0, 0.0, yaw), Twist2(0.1, 0.1), iter([(0.04, Twist2(0.1, 0.0))]), GroundModel())
    assert math.isnan(pose.x_m)
