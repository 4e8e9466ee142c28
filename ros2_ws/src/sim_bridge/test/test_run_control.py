import math

import pytest

from sim_bridge.faults import FaultRefused
from sim_bridge.pacing import LockStalled, Pacer, PacingSettings
from sim_bridge.run_control import RunControl, WrongStateError
from sim_bridge.simulator import Simulator
from sim_bridge.world import load_world
from tracked_description import load_robot
from tracked_types import PeriodGrid, Twist2, VelocityCommand

ROBOT = load_robot()
CONTROL = PeriodGrid(ROBOT.control.rate_hz)


@pytest.fixture
def make():
    """Function that makes a simulator, its run control and the list of delivered batches."""
    made = []

    def build(mode="unpaced", **tuning):
        simulator, delivered = Simulator(ROBOT, load_world("flat")), []
        made.append(simulator)
        pacer = Pacer(PacingSettings.from_robot(ROBOT, time_mode=mode, **tuning))
        return simulator, RunControl(simulator, pacer, delivered.append), delivered

    yield build
    for simulator in made:
        simulator.close()


def test_every_tick_is_delivered_in_order(make):
    _, run, delivered = make()
    assert [run.work(0.0) for _ in range(10)] == [0.0] * 10
    assert [batch.stamp_ns for batch in delivered] == [PeriodGrid(120).stamp_ns(k) for k in range(1, 11)]


def test_paced_run_says_how_long_to_wait(make):
    _, run, delivered = make("paced")
    assert run.work(3.0) == pytest.approx(1.0 / 120, abs=1e-6)
    assert not delivered
    assert run.work(3.0085) == 0.0
    assert len(delivered) == 1


def test_paused_time_stands_still_whatever_the_wall_clock_says(make):
    simulator, run, delivered = make()
    run.work(0.0)
    run.set_paused(True)
    assert run.work(100.0) > 0.0
    assert (simulator.stamp_ns, len(delivered)) == (8_333_333, 1)
    run.set_paused(False)
    assert run.work(100.0) == 0.0


def test_paused_run_does_not_rush_to_catch_up(make):
    _, run, delivered = make("paced")
    run.work(0.0)
    run.set_paused(True)
    run.set_paused(False)
    assert run.work(50.0) > 0.0
    assert not delivered


def test_steps_are_steps_of_the_physics(make):
    simulator, run, delivered = make()
    run.set_paused(True)
    run.step(3)
    assert (simulator.stamp_ns, delivered) == (6_250_000, [])
    run.step(5)
    assert (run.stamp_ns, len(delivered)) == (16_666_667, 2)


def test_stepping_needs_a_pause_and_a_sane_count(make):
    _, run, _ = make()
    with pytest.raises(WrongStateError, match="pause"):
        run.step(1)
    run.set_paused(True)
    for steps in (-1, 2**64 - 1):
        with pytest.raises(ValueError, match="steps"):
            run.step(steps)


def lock_stepped(make, answer):
    """Ticks run with 30 Hz commands that ``answer(stamp_ns)`` may withhold."""
    simulator, run, delivered = make("lock_step", lock_step_limit_s=1.0)
    wall_s = 0.0
    for _ in range(600):
        seen = len(delivered)
        run.work(wall_s)
        wall_s += 0.01
        if len(delivered) > seen and CONTROL.is_instant(simulator.stamp_ns) and answer(simulator.stamp_ns):
            simulator.submit(VelocityCommand(simulator.stamp_ns, Twist2(0.2, 0.0)))
    return simulator, delivered


def test_lock_step_runs_on_while_commands_come(make):
    simulator, delivered = lock_stepped(make, lambda stamp_ns: True)
    assert len(delivered) > 500
    assert simulator.intake.newest_stamp_ns > simulator.stamp_ns - 60_000_000


def test_lock_step_ends_when_commands_cease(make):
    with pytest.raises(LockStalled, match="no command"):
        lock_stepped(make, lambda stamp_ns: stamp_ns < 1_000_000_000)


def test_reset_frees_the_lock_until_a_new_first_command(make):
    simulator, run, delivered = make("lock_step")
    run.work(0.0)
    run.work(0.01)
    simulator.submit(VelocityCommand(simulator.stamp_ns, Twist2(0.1, 0.0)))
    while run.work(0.01) == 0.0:
        pass
    stuck = len(delivered)
    run.reset(5)
    assert simulator.intake.newest_stamp_ns is None
    run.work(0.02)
    run.work(0.03)
    assert len(delivered) == stuck + 1


def test_faults_last_as_long_as_asked(make):
    simulator, run, delivered = make()
    run.inject_fault("imu", "nan", 0.05, 0.0)
    for _ in range(12):
        run.work(0.0)
    bad = [math.isnan(batch.imu[0].angular_velocity_radps[0]) for batch in delivered]
    assert bad == [True] * 5 + [False] * 7
    run.inject_fault("imu", "blackout", 0.0, 0.0)
    run.work(0.0)
    assert delivered[-1].imu == ()
    run.end_faults("imu")
    run.work(0.0)
    assert len(delivered[-1].imu) == 1
    assert not simulator.sensors.active_faults(simulator.stamp_ns)


def test_faults_may_be_announced_for_later(make):
    simulator, run, delivered = make()
    run.inject_fault("imu", "nan", 0.025, 0.0, start_ns=50_000_000)
    assert not simulator.sensors.active_faults(simulator.stamp_ns)
    for _ in range(12):
        run.work(0.0)
    bad = {batch.stamp_ns for batch in delivered if math.isnan(batch.imu[0].angular_velocity_radps[0])}
    assert bad == {batch.stamp_ns for batch in delivered if 50_000_000 <= batch.stamp_ns < 75_000_000}
    assert len(bad) == 3


@pytest.mark.parametrize("duration", [-1.0, math.nan, math.inf])
def test_senseless_durations_are_refused(make, duration):
    _, run, _ = make()
    with pytest.raises(FaultRefused, match="duration"):
        run.inject_fault("imu", "nan", duration, 0.0)
    with pytest.raises(FaultRefused, match="sensor"):
        run.end_faults("nose")
