import contextlib
import math
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tracked_description import load_robot
from tracked_safety import SOURCES, ArbiterSettings, CommandArbiter, CommandRefused
from tracked_types import ArbiterMode, PeriodGrid, Twist2, VelocityCommand

CONTROL = PeriodGrid(30)
ODOMETRY = PeriodGrid(60)
SETTINGS = ArbiterSettings.from_robot(load_robot())
SLOW = Twist2(0.02, 0.05)


def command(index: int, twist: Twist2 = SLOW) -> VelocityCommand:
    return VelocityCommand(CONTROL.stamp_ns(index), twist)


def driving(speed: float = 0.5, yaw_rate: float = 0.6) -> CommandArbiter:
    """An arbiter that has forwarded nav for two seconds, up to control instant 60."""
    arbiter = CommandArbiter(SETTINGS)
    for index in range(61):
        arbiter.tick(CONTROL.stamp_ns(index))
        arbiter.offer("nav", command(index, Twist2(speed, yaw_rate)))
    return arbiter


def refusal_of(arbiter: CommandArbiter, source: str, offered: VelocityCommand) -> str:
    with pytest.raises(CommandRefused) as refusal:
        arbiter.offer(source, offered)
    return refusal.value.reason


def run_silent(arbiter: CommandArbiter, first: int, last: int) -> list[VelocityCommand]:
    """Odometry alone, from one control instant to another."""
    ticks = (arbiter.tick(ODOMETRY.stamp_ns(index)) for index in range(2 * first, 2 * last))
    return [sent for sent in ticks if sent is not None]


def test_a_command_passes_in_the_same_call_with_its_stamp() -> None:
    arbiter = CommandArbiter(SETTINGS)
    assert arbiter.offer("nav", command(7)) == command(7)
    assert arbiter.state.mode is ArbiterMode.FORWARDING and arbiter.state.source == "nav"


def test_every_command_of_a_live_source_gives_exactly_one() -> None:
    arbiter = CommandArbiter(SETTINGS)
    for index in range(100):
        assert arbiter.tick(CONTROL.stamp_ns(index)) is None
        assert arbiter.offer("nav", command(index)) == command(index)


def test_higher_priority_takes_over_at_once_and_lower_is_held_back() -> None:
    arbiter = CommandArbiter(SETTINGS)
    assert arbiter.offer("nav", command(0)) is not None
    assert arbiter.offer("teleop", command(1)) == command(1)
    assert arbiter.offer("nav", command(2)) is None
    assert arbiter.offer("follow", command(2)) is None
    assert arbiter.state.source == "teleop"


def test_lower_priority_takes_over_once_the_higher_is_silent() -> None:
    arbiter = CommandArbiter(SETTINGS)
    for index in range(12):
        arbiter.tick(CONTROL.stamp_ns(index))
        if index < 3:
            arbiter.offer("teleop", command(index))
        passed = arbiter.offer("nav", command(index))
        assert (passed is not None) == (index > 2 + 6)  # six control periods are 0.2 s
    assert arbiter.state.source == "nav"


def test_silence_ramps_to_zero_within_braking_limits_and_stays_there() -> None:
    arbiter = driving()
    assert run_silent(arbiter, 60, 66) == []
    ramp = run_silent(arbiter, 66, 100)
    assert arbiter.state.mode is ArbiterMode.STOPPED and arbiter.state.reason == "nav silent for 0.2 s"
    speeds = [0.5] + [sent.twist.speed_mps for sent in ramp]
    assert all(0.0 <= a - b <= SETTINGS.limits.braking_mps2 / 30.0 * (1.0 + 1e-6) for a, b in pairwise(speeds))
    assert ramp[-1].twist == Twist2(0.0, 0.0)
    stamps = [sent.stamp_ns for sent in ramp]
    assert stamps == [CONTROL.stamp_ns(CONTROL.index_at(stamp)) for stamp in stamps] and sorted(set(stamps)) == stamps


def test_zero_is_kept_up_until_fresh_commands_arrive() -> None:
    arbiter = driving()
    run_silent(arbiter, 60, 120)
    assert len(run_silent(arbiter, 120, 150)) == 30
    assert arbiter.offer("nav", command(150)) is not None
    assert arbiter.state.mode is ArbiterMode.FORWARDING and arbiter.state.reason == ""


def test_an_arbiter_nobody_has_commanded_is_silent() -> None:
    arbiter = CommandArbiter(SETTINGS)
    assert run_silent(arbiter, 0, 60) == []
    assert arbiter.state.mode is ArbiterMode.IDLE


def test_a_jump_in_the_command_is_limited_and_counted() -> None:
    arbiter = CommandArbiter(SETTINGS)
    sent = arbiter.offer("nav", command(0, Twist2(0.5, 1.3)))
    assert sent is not None
    assert sent.twist.speed_mps == pytest.approx(SETTINGS.limits.acceleration_mps2 / 30.0)
    assert sent.twist.yaw_rate_radps == pytest.approx(SETTINGS.limits.yaw_acceleration_radps2 / 30.0)
    assert arbiter.cut_off["nav"] == 1


def test_a_gap_between_commands_earns_no_larger_step() -> None:
    arbiter = CommandArbiter(SETTINGS)
    arbiter.offer("nav", command(0, Twist2(0.0, 0.0)))
    sent = arbiter.offer("nav", command(5, Twist2(0.5, 0.0)))
    assert sent is not None
    assert sent.twist.speed_mps == pytest.approx(2.0 * SETTINGS.limits.acceleration_mps2 / 30.0)


@pytest.mark.parametrize(
    ("wrong", "reason"),
    [
        (Twist2(math.nan, 0.0), "not finite"),
        (Twist2(0.0, math.inf), "not finite"),
        (Twist2(-math.inf, math.nan), "not finite"),
        (Twist2(9.0, 0.0), "beyond 1.5 times a limit"),
        (Twist2(0.0, -40.0), "beyond 1.5 times a limit"),
    ],
)
def test_an_impossible_command_is_refused_with_its_reason(wrong: Twist2, reason: str) -> None:
    arbiter = CommandArbiter(SETTINGS)
    assert refusal_of(arbiter, "teleop", command(0, wrong)) == reason
    assert arbiter.state.mode is ArbiterMode.IDLE


def test_a_source_that_sends_only_nonsense_is_silent() -> None:
    arbiter = driving()
    for index in range(61, 90):
        arbiter.tick(CONTROL.stamp_ns(index))
        assert refusal_of(arbiter, "nav", command(index, Twist2(math.nan, 0.0))) == "not finite"
    assert arbiter.state.mode is ArbiterMode.STOPPED


@pytest.mark.parametrize(
    ("stamp_ns", "reason"),
    [
        (CONTROL.stamp_ns(60), "stamp repeated or out of order"),
        (CONTROL.stamp_ns(50), "stamp repeated or out of order"),
        (CONTROL.stamp_ns(80), "stamp in the future"),
    ],
)
def test_a_command_out_of_time_is_refused(stamp_ns: int, reason: str) -> None:
    assert refusal_of(driving(), "nav", VelocityCommand(stamp_ns, SLOW)) == reason


def test_a_source_without_stamps_is_refused() -> None:
    arbiter = driving()
    run_silent(arbiter, 60, 120)
    assert refusal_of(arbiter, "teleop", VelocityCommand(0, SLOW)) == "older than what was sent"


def test_a_stale_first_command_is_refused() -> None:
    arbiter = CommandArbiter(SETTINGS)
    arbiter.tick(CONTROL.stamp_ns(100))
    assert refusal_of(arbiter, "nav", command(10)) == "stale stamp"


def test_emergency_stop_ramps_and_ignores_every_source() -> None:
    arbiter = driving()
    arbiter.set_e_stop(True)
    for index in range(61, 90):
        sent = arbiter.tick(CONTROL.stamp_ns(index))
        assert sent is not None
        assert arbiter.offer("teleop", command(index)) is None
    assert sent.twist == Twist2(0.0, 0.0)
    assert arbiter.state.mode is ArbiterMode.EMERGENCY_STOP and arbiter.state.reason == "emergency stop pressed"


def test_emergency_stop_latches_until_it_is_let_go_and_released() -> None:
    arbiter = driving()
    arbiter.set_e_stop(True)
    assert arbiter.release() == "the emergency stop is still pressed"
    arbiter.set_e_stop(False)
    assert arbiter.state.mode is ArbiterMode.EMERGENCY_STOP
    assert arbiter.offer("nav", command(61)) is None
    assert arbiter.release() is None
    assert arbiter.release() == "no stop is latched"
    assert arbiter.offer("nav", command(62)) is not None


def test_emergency_stop_before_any_command_holds_zero() -> None:
    arbiter = CommandArbiter(SETTINGS)
    arbiter.set_e_stop(True)
    assert [sent.twist for sent in run_silent(arbiter, 10, 13)] == [Twist2(0.0, 0.0)] * 3


def test_an_emergency_stop_may_be_pressed_without_a_signal_that_is_kept_up() -> None:
    arbiter = driving()
    arbiter.press_e_stop()
    assert arbiter.offer("nav", command(61)) is None
    assert arbiter.release() is None
    assert arbiter.state.reason == "emergency stop pressed; released, waiting for fresh commands"
    assert arbiter.offer("nav", command(62)) is not None


def test_a_lock_keeps_its_source_and_those_below_from_passing_and_not_those_above() -> None:
    arbiter = driving()
    arbiter.set_lock("follow", locked=True)
    assert arbiter.state.mode is ArbiterMode.STOPPING and arbiter.state.reason == "nav is locked"
    ramp = []
    for index in range(61, 90):
        ramp.append(arbiter.tick(CONTROL.stamp_ns(index)))
        assert arbiter.offer("nav", command(index)) is None
        assert arbiter.offer("follow", command(index)) is None
    assert ramp[-1] is not None and ramp[-1].twist == Twist2(0.0, 0.0)
    assert arbiter.offer("teleop", command(90)) is not None
    arbiter.set_lock("follow", locked=False)
    for index in range(91, 100):
        arbiter.tick(CONTROL.stamp_ns(index))
        passed = arbiter.offer("nav", command(index))
    assert passed is not None


def test_clock_that_jumps_back_stops_the_robot_until_fresh_commands() -> None:
    arbiter = driving()
    first = arbiter.tick(CONTROL.stamp_ns(1))
    assert first is not None and first.stamp_ns == CONTROL.stamp_ns(1)
    assert 0.0 < first.twist.speed_mps < 0.5
    assert arbiter.state.mode is ArbiterMode.STOPPING and arbiter.state.reason == "clock jumped back"
    assert arbiter.offer("nav", command(2)) is not None


def test_stop_gives_the_whole_ramp_for_a_shutdown() -> None:
    arbiter = driving()
    ramp = arbiter.stop("shutting down")
    assert {sent.stamp_ns for sent in ramp} == {CONTROL.stamp_ns(60)}
    assert ramp[-1].twist == Twist2(0.0, 0.0) and len(ramp) == 10
    assert CommandArbiter(SETTINGS).stop("shutting down") == []


def test_wall_clock_silence_ramps_with_the_newest_stamp() -> None:
    arbiter = driving()
    ramp = [arbiter.lost_time() for _ in range(15)]
    assert [sent.stamp_ns for sent in ramp if sent] == [CONTROL.stamp_ns(60)] * 15
    assert ramp[-1] is not None and ramp[-1].twist == Twist2(0.0, 0.0)
    assert arbiter.state.reason == "nav and the odometry silent"
    assert arbiter.offer("nav", command(61)) is not None
    assert CommandArbiter(SETTINGS).lost_time() is None


def test_an_unknown_source_is_an_error() -> None:
    with pytest.raises(ValueError, match="unknown source 'joystick'"):
        CommandArbiter(SETTINGS).offer("joystick", command(0))
    with pytest.raises(ValueError, match="unknown source 'joystick'"):
        CommandArbiter(SETTINGS).set_lock("joystick", locked=True)


EVENT = st.one_of(
    st.tuples(st.sampled_from(SOURCES), st.integers(-5, 20), st.floats(), st.floats()),
    st.tuples(st.just("tick"), st.integers(-40, 20), st.just(0.0), st.just(0.0)),
    st.tuples(st.sampled_from(["press", "let go", "release", "stop", "lost"]), st.just(0), st.just(0.0), st.just(0.0)),
)


@given(events=st.lists(EVENT, max_size=60))
def test_whatever_happens_the_base_gets_permitted_commands_of_limited_acceleration(
    events: list[tuple[str, int, float, float]],
) -> None:
    arbiter = CommandArbiter(SETTINGS)
    now = 100
    sent: list[VelocityCommand] = []
    for kind, step, speed, yaw_rate in events:
        if kind == "tick":
            now = max(now + step, 0)
            outputs = [arbiter.tick(ODOMETRY.stamp_ns(now))]
        elif kind in SOURCES:
            stamp = ODOMETRY.stamp_ns(max(now + step, 0))
            outputs = []
            with contextlib.suppress(CommandRefused):
                outputs.append(arbiter.offer(kind, VelocityCommand(stamp, Twist2(speed, yaw_rate))))
        elif kind == "stop":
            outputs = list(arbiter.stop("test"))
        elif kind == "lost":
            outputs = [arbiter.lost_time()]
        elif kind == "release":
            arbiter.release()
            outputs = []
        else:
            arbiter.set_e_stop(kind == "press")
            outputs = []
        sent += [output for output in outputs if output is not None]
    limits = SETTINGS.limits
    previous = Twist2(0.0, 0.0)
    for output in sent:
        assert limits.excess(output.twist) <= 1.0 + 1e-9
        largest = 2.0 / SETTINGS.rate_hz
        assert abs(output.twist.speed_mps - previous.speed_mps) <= limits.braking_mps2 * largest * (1.0 + 1e-5)
        previous = output.twist
