import dataclasses
import hashlib
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sim_bridge.command_intake import CommandRefused
from sim_bridge.faults import Fault
from sim_bridge.physics_settings import PhysicsSettings
from sim_bridge.simulator import Simulator, SimulatorSettings
from sim_bridge.world import load_world
from tracked_description import load_robot
from tracked_types import PeriodGrid, Pose2, Twist2, VelocityCommand

ROBOT = load_robot()
FLAT = load_world("flat")
CONTROL = PeriodGrid(ROBOT.control.rate_hz)
TICKS_PER_SECOND = ROBOT.imu.rate_hz


@pytest.fixture
def make():
    """Function that makes a simulator and closes it after the test."""
    made = []

    def build(world=FLAT, robot=ROBOT, seed=0, start=None, **choices):
        made.append(Simulator(robot, world, SimulatorSettings(**choices), seed=seed, start=start))
        return made[-1]

    yield build
    for simulator in made:
        simulator.close()


def drive(simulator, seconds, speed=0.0, yaw_rate=0.0):
    """Batches of that long, with a command answering every 30 Hz instant."""
    batches = []
    for _ in range(round(seconds * TICKS_PER_SECOND)):
        batches.append(simulator.advance())
        if CONTROL.is_instant(simulator.stamp_ns):
            simulator.submit(VelocityCommand(simulator.stamp_ns, Twist2(speed, yaw_rate)))
    return batches


def digest(batches):
    """SHA-256 over every number that the sensors delivered."""
    hashed = hashlib.sha256()
    for batch in batches:
        for sample in (*batch.imu, *batch.tracks, *batch.scans, *batch.truth, *batch.truth_slip):
            for value in (getattr(sample, field.name) for field in dataclasses.fields(sample)):
                hashed.update(value.tobytes() if isinstance(value, np.ndarray) else repr(value).encode())
        hashed.update(batch.suspension_travel_m.tobytes())
    return hashed.hexdigest()


def test_streams_come_at_their_rates_on_exact_grids(make):
    batches = drive(make(), 1.0)
    imu = [sample.stamp_ns for batch in batches for sample in batch.imu]
    tracks = [sample.stamp_ns for batch in batches for sample in batch.tracks]
    truth = [sample.stamp_ns for batch in batches for sample in batch.truth]
    assert imu == [PeriodGrid(120).stamp_ns(k) for k in range(1, 121)]
    assert tracks == truth == [PeriodGrid(60).stamp_ns(k) for k in range(1, 61)]
    assert [scan.stamp_ns for batch in batches for scan in batch.scans] == [k * 100_000_000 for k in range(10)]


def test_same_seed_and_commands_give_bit_identical_streams(make):
    world = load_world("rooms")
    first, second, other = (digest(drive(make(world, seed=seed), 1.5, 0.3, 0.4)) for seed in (7, 7, 8))
    assert first == second
    assert first != other


def test_warming_up_leaves_no_trace(make):
    cold, warm = make(), make()
    warm.warm_up()
    assert digest(drive(cold, 0.3, 0.4)) == digest(drive(warm, 0.3, 0.4))


def test_reset_is_as_good_as_new(make):
    fresh, used = make(seed=3), make(seed=9)
    drive(used, 1.2, 0.4, -0.5)
    used.inject(Fault("imu", "nan"))
    used.reset(3)
    assert used.stamp_ns == 1_200_000_000
    for a, b in zip(drive(fresh, 0.5), drive(used, 0.5), strict=True):
        np.testing.assert_array_equal(a.imu[0].angular_velocity_radps, b.imu[0].angular_velocity_radps)
        np.testing.assert_array_equal(a.suspension_travel_m, b.suspension_travel_m)


def test_command_acts_at_its_stamp_plus_the_delay_whenever_it_arrives(make):
    early, late = make(seed=1), make(seed=1)
    command = VelocityCommand(0, Twist2(0.4, 0.0))
    early.submit(command)
    batches_early = [early.advance() for _ in range(12)]
    batches_late = [late.advance() for _ in range(4)]
    late.submit(command)
    batches_late += [late.advance() for _ in range(8)]
    assert digest(batches_early) == digest(batches_late)
    speeds = [batch.truth[0].velocity_mps[0] for batch in batches_early if batch.truth]
    assert abs(speeds[0]) < 1e-3 < 0.01 < speeds[-1]


def test_drives_where_it_is_told(make):
    simulator = make()
    truth = drive(simulator, 2.0, 0.4)[-1].truth[0]
    assert truth.velocity_mps[0] == pytest.approx(0.4, abs=0.01)
    truth = drive(simulator, 1.0, 0.0, 0.5)[-1].truth[0]
    assert 0.3 < truth.angular_velocity_radps[2] < 0.5


def test_truth_slip_is_the_yaw_that_belts_lose_and_agrees_with_gyro_and_encoders(make):
    batches = drive(make(), 3.0, 0.0, 0.8)[-TICKS_PER_SECOND:]
    gyro = np.mean([sample.angular_velocity_radps[2] for batch in batches for sample in batch.imu])
    tracks = [sample for batch in batches for sample in batch.tracks]
    belts = np.mean([t.right_speed_mps - t.left_speed_mps for t in tracks]) / ROBOT.tracks.gauge_m
    slip = np.mean([sample.yaw_rate_radps for batch in batches for sample in batch.truth_slip])
    assert belts == pytest.approx(0.8, abs=0.02)
    assert slip == pytest.approx(gyro - ROBOT.imu.gyro_bias_radps - belts, abs=0.01)
    assert slip / belts == pytest.approx(-0.21, abs=0.04)


def test_silence_stops_the_robot(make):
    simulator = make()
    drive(simulator, 1.0, 0.4)
    stopped = [simulator.advance() for _ in range(TICKS_PER_SECOND)]
    # The chassis still rocks on its soft suspension.
    assert abs(stopped[-1].truth[0].velocity_mps[0]) < 0.02
    assert simulator.intake.timed_out(simulator.stamp_ns)


not_finite = st.sampled_from([math.nan, math.inf, -math.inf])
too_fast = st.floats(ROBOT.limits.speed_max_mps + 1e-6, 1e300) | st.floats(-1e300, ROBOT.limits.speed_min_mps - 1e-6)
too_quick = st.floats(ROBOT.limits.yaw_rate_max_radps + 1e-6, 1e300)
any_stamp = st.integers(-(10**18), 10**18)
garbage = (
    st.tuples(any_stamp, not_finite | too_fast, st.floats())
    | st.tuples(any_stamp, st.floats(), not_finite | too_quick | too_quick.map(lambda rate: -rate))
    | st.tuples(st.integers(10**9, 10**18) | st.integers(-(10**18), -(10**9)), st.just(0.3), st.just(0.3))
)


@settings(max_examples=20, deadline=None)
@given(st.lists(garbage, max_size=10))
def test_garbage_never_moves_nor_breaks_the_robot(commands):
    simulator = Simulator(ROBOT, FLAT)
    for stamp, speed, yaw_rate in commands:
        with pytest.raises(CommandRefused):
            simulator.submit(VelocityCommand(stamp, Twist2(speed, yaw_rate)))
        simulator.advance()
    truth = [batch for batch in (simulator.advance() for _ in range(8)) if batch.truth][-1].truth[0]
    simulator.close()
    assert sum(simulator.intake.refused.values()) == len(commands)
    assert math.hypot(*truth.position_m[:2]) < 1e-3


def test_fault_reaches_its_sensor_at_its_time_and_ends(make):
    simulator = make()
    simulator.inject(Fault("tracks", "nan", 500_000_000, 600_000_000))
    bad = [s.stamp_ns for b in drive(simulator, 1.0) for s in b.tracks if math.isnan(s.left_travel_m)]
    assert 500_000_000 <= min(bad) <= max(bad) < 600_000_000
    simulator.inject(Fault("scan", "blackout", simulator.stamp_ns))
    assert [fault.kind for fault in simulator.sensors.active_faults(simulator.stamp_ns)] == ["blackout"]
    assert not any(batch.scans for batch in drive(simulator, 0.5))
    simulator.end_faults("scan")
    assert any(batch.scans for batch in drive(simulator, 0.2))


def test_robot_put_elsewhere_feels_no_shock(make):
    simulator = make()
    drive(simulator, 0.5)
    simulator.place_robot(Pose2(2.0, -1.0, 2.5))
    batches = drive(simulator, 0.2)
    truth = batches[-1].truth[0]
    assert (truth.pose.x_m, truth.pose.yaw_rad) == pytest.approx((2.0, 2.5), abs=1e-3)
    assert max(np.abs(b.imu[0].angular_velocity_radps).max() for b in batches) < 0.2
    assert max(abs(b.truth_slip[0].speed_mps) for b in batches if b.truth_slip) < 0.05


def test_physics_steps_add_up_to_ticks(make):
    simulator = make(physics=PhysicsSettings(physics_rate_hz=960))
    delivered = [simulator.step() for _ in range(16)]
    assert [k for k, batch in enumerate(delivered) if batch] == [7, 15]
    assert simulator.stamp_ns == delivered[-1].stamp_ns == 16_666_667
    assert simulator.next_tick_ns == 25_000_000


def test_lidar_sees_walls_and_not_the_robot(make):
    simulator = make(load_world("rooms"), lidar_mode="instant")
    ranges = next(scan for batch in drive(simulator, 0.1) for scan in batch.scans).ranges_m
    finite = ranges[np.isfinite(ranges)]
    assert len(finite) > 300 and finite.min() > 0.3
    assert not np.isnan(ranges).any()


@pytest.mark.parametrize("choice", [{"physics": PhysicsSettings(physics_rate_hz=500)}])
def test_rates_that_do_not_fit_are_refused(make, choice):
    with pytest.raises(ValueError, match="multiple of 120"):
        make(**choice)


def test_sensor_rates_that_do_not_fit_are_refused(make):
    odometry = ROBOT.odometry.model_copy(update={"rate_hz": 50})
    with pytest.raises(ValueError, match=r"odometry\.rate_hz"):
        make(robot=ROBOT.model_copy(update={"odometry": odometry}))
