import itertools

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sim_bridge.pacing import LockStalled, Pacer, PacingSettings, RealTimeMeter
from tracked_description import load_robot
from tracked_types import PeriodGrid

ROBOT = load_robot()
TICKS = PeriodGrid(120)
CONTROL = PeriodGrid(ROBOT.control.rate_hz)
PERIOD_S = 1.0 / 120


def pacer(mode, **tuning):
    return Pacer(PacingSettings.from_robot(ROBOT, time_mode=mode, **tuning))


def may(pacer, tick, wall_s, newest_ns=None):
    return pacer.wait_s(TICKS.stamp_ns(tick), TICKS.stamp_ns(tick + 1), newest_ns, wall_s) == 0.0


def run(pacer, calls):
    """Ticks after each call at the given wall times, advancing whenever it is allowed."""
    tick, history = 0, []
    for wall_s in calls:
        while may(pacer, tick, wall_s):
            tick += 1
        history.append(tick)
    return history


def test_paced_time_follows_the_wall_clock():
    history = run(pacer("paced"), [100.0 + 0.5 * k * PERIOD_S for k in range(241)])
    assert history[0] == 0
    assert history[-1] in (119, 120)
    assert max(b - a for a, b in itertools.pairwise(history)) == 1


def test_paced_tick_knows_how_long_it_waits():
    paced = pacer("paced")
    may(paced, 0, 7.0)
    assert paced.wait_s(0, TICKS.stamp_ns(1), None, 7.005) == pytest.approx(PERIOD_S - 0.005)


def test_small_lag_is_made_up_for():
    assert run(pacer("paced"), [0.0, 0.04, 0.05])[-1] == 6


def test_long_stall_slows_the_world_instead_of_a_burst():
    history = run(pacer("paced"), [0.0, 5.0, 5.0 + 1.01 * PERIOD_S])
    assert history == [0, 0, 1]


def test_unpaced_time_never_waits():
    assert all(may(pacer("unpaced"), tick, 0.0) for tick in range(1000))


def test_lock_step_keeps_real_time_until_the_first_command():
    locked = pacer("lock_step")
    assert not may(locked, 0, 0.0)
    assert may(locked, 0, 1.01 * PERIOD_S)


def test_lock_step_awaits_the_first_command_at_its_instant_but_not_for_ever():
    locked, tick = pacer("lock_step", first_command_s=0.3), 0
    for wall_s in (0.0, *(0.1 + 0.5 * PERIOD_S * k for k in range(120))):
        while may(locked, tick, wall_s):
            tick += 1
    assert TICKS.stamp_ns(tick) == pytest.approx(300_000_000 + 16_666_667, abs=2)
    assert not may(locked, tick, 1.9)
    assert [may(locked, tick, wall_s) for wall_s in (2.5, 2.5 + 1.01 * PERIOD_S)] == [False, True]


def test_lock_step_stops_one_control_and_one_odometry_period_after_the_newest_command():
    locked, tick = pacer("lock_step"), 12
    while may(locked, tick, 0.0, TICKS.stamp_ns(12)):
        tick += 1
    assert tick == 12 + 4 + 2


@given(st.integers(0, 10**7))
def test_lock_step_always_lets_the_next_control_instant_and_its_odometry_happen(instant):
    locked, newest = pacer("lock_step"), CONTROL.stamp_ns(instant)
    tick = TICKS.index_at(newest)
    while may(locked, tick, 0.0, newest):
        tick += 1
    assert TICKS.stamp_ns(tick) >= CONTROL.stamp_ns(instant + 1) + 16_666_666


def test_lock_step_without_commands_ends_with_a_clear_error():
    locked = pacer("lock_step", lock_step_limit_s=2.0)
    assert not may(locked, 100, 0.0, 0)
    assert not may(locked, 100, 1.9, 0)
    assert locked.waited_s(1.9) == 1.9
    with pytest.raises(LockStalled, match=r"no command for 2\.1 s"):
        may(locked, 100, 2.1, 0)


def test_time_spent_paused_does_not_count_as_a_stall():
    locked = pacer("lock_step", lock_step_limit_s=2.0)
    assert not may(locked, 100, 0.0, 0)
    locked.restart()
    assert not may(locked, 100, 60.0, 0)


@pytest.mark.parametrize("tuning", [{"time_mode": "warp"}, {"lock_step_limit_s": 0.0}, {"lock_step_limit_s": "x"}])
def test_bad_settings_are_named(tuning):
    with pytest.raises(ValueError, match=next(iter(tuning))):
        PacingSettings.from_robot(ROBOT, **tuning)


def test_meter_tells_simulated_from_wall_time():
    meter = RealTimeMeter()
    assert meter.update(0, 50.0) == 0.0
    assert meter.update(1_500_000_000, 51.0) == pytest.approx(1.5)
    for k in range(1, 100):
        factor = meter.update(1_500_000_000 + k * 50_000_000, 51.0 + 0.1 * k)
    assert factor == pytest.approx(0.5)
