import contextlib
import itertools
import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sim_bridge.command_intake import CommandIntake, CommandRefused, IntakeSettings
from tracked_description import load_robot
from tracked_types import Twist2, VelocityCommand, to_nanoseconds

ROBOT = load_robot()
SETTINGS = IntakeSettings.from_robot(ROBOT)
STEP_S = 1.0 / 480
MS = 1_000_000


def command(stamp_ns, speed=0.3, yaw_rate=0.0):
    return VelocityCommand(stamp_ns, Twist2(speed, yaw_rate))


def twists(intake, start_s, end_s):
    steps = range(round(start_s / STEP_S), round(end_s / STEP_S))
    return {k * STEP_S: intake.update(to_nanoseconds(k * STEP_S), STEP_S) for k in steps}


def test_stands_still_until_commanded():
    intake = CommandIntake(SETTINGS)
    assert set(twists(intake, 0.0, 1.0).values()) == {Twist2(0.0, 0.0)}
    assert not intake.timed_out(10**12)


def test_acts_at_its_stamp_plus_the_transport_delay_however_early_it_arrives():
    intake = CommandIntake(SETTINGS)
    intake.submit(command(100 * MS), 100 * MS)
    moving = [time for time, twist in twists(intake, 0.1, 0.2).items() if twist.speed_mps]
    assert moving[0] == pytest.approx(0.14, abs=STEP_S)


def test_late_arrival_acts_at_once():
    intake = CommandIntake(SETTINGS)
    intake.submit(command(100 * MS), 180 * MS)
    assert intake.update(180 * MS, STEP_S).speed_mps == 0.3


def test_commands_wait_their_turn():
    intake = CommandIntake(SETTINGS)
    for stamp, speed in ((100, 0.1), (133, 0.2), (150, 0.3)):
        intake.submit(command(stamp * MS, speed), 150 * MS)
    assert [intake.update(t * MS, STEP_S).speed_mps for t in (141, 172, 174, 189, 191)] == [0.1, 0.1, 0.2, 0.2, 0.3]


def test_same_stamp_replaces_so_that_a_stop_can_follow():
    intake = CommandIntake(SETTINGS)
    intake.submit(command(100 * MS, 0.4), 100 * MS)
    intake.submit(command(100 * MS, 0.0), 101 * MS)
    assert intake.update(140 * MS, STEP_S).speed_mps == 0.0


def test_silence_ramps_to_rest_within_the_braking_limit():
    intake = CommandIntake(SETTINGS)
    intake.submit(command(0, 0.45, 1.2), 0)
    history = list(twists(intake, 0.05, 1.5).items())
    before = [twist for time, twist in history if time < 0.2]
    assert set(before) == {Twist2(0.45, 1.2)}
    for (_, one), (_, two) in itertools.pairwise(history):
        assert 0.0 <= one.speed_mps - two.speed_mps <= ROBOT.limits.braking_mps2 * STEP_S + 1e-12
        assert 0.0 <= one.yaw_rate_radps - two.yaw_rate_radps <= ROBOT.limits.yaw_acceleration_radps2 * STEP_S + 1e-12
    at_rest = next(time for time, twist in history if twist.speed_mps == 0.0)
    assert at_rest == pytest.approx(0.2 + 0.45 / ROBOT.limits.braking_mps2, abs=2 * STEP_S)
    assert history[-1][1] == Twist2(0.0, 0.0)


def test_recovers_when_commands_come_back():
    intake = CommandIntake(SETTINGS)
    intake.submit(command(0), 0)
    twists(intake, 0.0, 1.0)
    intake.submit(command(1000 * MS, -0.2), 1000 * MS)
    assert intake.update(1040 * MS, STEP_S).speed_mps == -0.2
    assert not intake.timed_out(1040 * MS)


@pytest.mark.parametrize(
    ("bad", "reason"),
    [
        (command(500 * MS, math.nan), "not finite"),
        (command(500 * MS, 0.0, math.inf), "not finite"),
        (command(500 * MS, ROBOT.limits.speed_max_mps + 0.01), "speed over limit"),
        (command(500 * MS, ROBOT.limits.speed_min_mps - 0.01), "speed over limit"),
        (command(500 * MS, 0.0, -ROBOT.limits.yaw_rate_max_radps - 0.01), "yaw rate over limit"),
        (command(501 * MS), "stamped in the future"),
        (command(250 * MS), "stale"),
        (command(440 * MS), "out of order"),
    ],
)
def test_bad_command_is_refused_counted_and_changes_nothing(bad, reason):
    intake = CommandIntake(SETTINGS)
    intake.submit(command(450 * MS, 0.1), 450 * MS)
    with pytest.raises(CommandRefused, match=reason) as refusal:
        intake.submit(bad, 500 * MS)
    assert refusal.value.reason == reason
    assert intake.refused == {reason: 1}
    assert intake.newest_stamp_ns == 450 * MS
    assert intake.update(500 * MS, STEP_S) == Twist2(0.1, 0.0)


def test_the_limits_themselves_are_allowed():
    intake = CommandIntake(SETTINGS)
    limits = ROBOT.limits
    intake.submit(command(0, limits.speed_max_mps, -limits.yaw_rate_max_radps), 0)
    intake.submit(command(1, limits.speed_min_mps, limits.yaw_rate_max_radps), 1)
    assert not intake.refused


def test_reset_stands_still_and_accepts_older_stamps():
    intake = CommandIntake(SETTINGS)
    intake.submit(command(900 * MS), 900 * MS)
    intake.reset()
    assert intake.update(950 * MS, STEP_S) == Twist2(0.0, 0.0)
    intake.submit(command(100 * MS), 100 * MS)
    assert intake.newest_stamp_ns == 100 * MS


anything = st.floats(allow_nan=True, allow_infinity=True)
stamps = st.integers(-(2**63), 2**63 - 1) | st.integers(0, 10**9)


@given(st.lists(st.tuples(stamps, anything, anything), max_size=30))
def test_no_sequence_of_commands_exceeds_the_limits(commands):
    intake, limits = CommandIntake(SETTINGS), ROBOT.limits
    for k, (stamp, speed, yaw_rate) in enumerate(commands):
        now = k * 10 * MS
        with contextlib.suppress(CommandRefused):
            intake.submit(command(stamp, speed, yaw_rate), now)
        twist = intake.update(now, STEP_S)
        assert limits.speed_min_mps - 1e-9 <= twist.speed_mps <= limits.speed_max_mps + 1e-9
        assert abs(twist.yaw_rate_radps) <= limits.yaw_rate_max_radps + 1e-9
