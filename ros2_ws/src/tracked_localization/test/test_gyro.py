import math
from dataclasses import replace

import numpy as np
import pytest

from tracked_localization.gyro_gate import GyroGate
from tracked_localization.gyro_record import GyroRecord
from tracked_localization.health import Fault
from tracked_localization.mounting import up_axis
from tracked_types import ImuSample

PERIOD_NS = 1_000_000_000 // 120


def sample(index, rate):
    wobble = 1e-4 * math.sin(index)
    return ImuSample(
        index * PERIOD_NS, "imu_link", np.array([wobble, 0.0, rate]), np.array([0.0, 0.0, 9.8]), np.eye(3), np.eye(3)
    )


@pytest.fixture
def gate(settings):
    gate = GyroGate(settings)
    for index in range(10):
        gate.update(sample(index, 0.0), 0.0, 1e-4, 0.0)
    return gate


def readings(gate, rates, first=10, belts=0.0, expected=0.0):
    return [gate.update(sample(first + index, rate), expected, 1e-4, belts) for index, rate in enumerate(rates)]


@pytest.mark.parametrize("bad", [math.nan, math.inf])
def test_numbers_that_are_none_are_named_wherever_they_stand(gate, bad):
    good = sample(10, 0.0)
    for field in ("angular_velocity_radps", "linear_acceleration_mps2"):
        assert (
            gate.update(replace(good, **{field: np.array([bad, 0.0, 0.0])}), 0.0, 1e-4, 0.0).fault is Fault.NOT_FINITE
        )


def test_single_shock_is_refused_without_blame(gate):
    shock, *after = readings(gate, [0.4, 0.0, 0.0])
    assert shock.rate_radps is None and shock.fault is None
    assert all(reading.rate_radps is not None for reading in after)


def test_offset_is_named_and_not_trusted_until_it_agrees_with_the_belts(gate):
    first = readings(gate, [1.5] * 100)
    assert first[0].fault is Fault.JUMP
    assert all(reading.rate_radps is None for reading in first)
    again = readings(gate, [0.0] * 20, first=110)
    assert again[0].rate_radps is None
    assert again[-1].rate_radps is not None


def test_turn_that_a_blow_explains_is_believed(gate):
    blow = replace(sample(10, 1.2), linear_acceleration_mps2=np.array([-15.0, 5.0, 9.8]))
    assert gate.update(blow, 0.0, 1e-4, 0.0).rate_radps == pytest.approx(1.2)
    after = readings(gate, [1.1, 1.0, 0.9], first=11, expected=1.0)
    assert all(reading.rate_radps is not None for reading in after)


def test_without_belts_the_gate_reopens(gate):
    assert readings(gate, [1.5] * 100, belts=None)[-1].rate_radps == pytest.approx(1.5)


def test_beyond_what_the_robot_can_do_is_named(gate):
    assert readings(gate, [50.0])[0].fault is Fault.IMPLAUSIBLE


def repeated(settings, count):
    gate = GyroGate(settings)
    first = sample(0, 0.0)
    return [gate.update(replace(first, stamp_ns=index * PERIOD_NS), 0.0, 1e-4, 0.0) for index in range(count)]


def test_identical_readings_are_stuck_within_a_tenth_of_a_second(settings):
    faults = [reading.fault for reading in repeated(settings, 13)]
    assert faults.index(Fault.STUCK) <= 12


def test_noiseless_gyro_may_repeat_itself(settings):
    assert not any(reading.fault for reading in repeated(replace(settings, gyro_noise_radps=0.0), 50))


def test_repetition_watch_can_be_switched_off(settings):
    assert not any(reading.fault for reading in repeated(replace(settings, stuck_samples=0), 50))


def test_mean_covers_exactly_the_period_asked_for():
    record = GyroRecord()
    for index in range(5):
        record.add(index * PERIOD_NS, float(index))
    mean, count = record.mean(2 * PERIOD_NS, 4 * PERIOD_NS)
    assert mean == pytest.approx(3.5)
    assert count == pytest.approx(2.0)
    mean, _ = record.mean(2 * PERIOD_NS + PERIOD_NS // 2, 4 * PERIOD_NS)
    assert mean == pytest.approx((0.5 * 3.0 + 4.0) / 1.5, rel=1e-6)


def test_mean_is_none_where_readings_are_missing():
    record = GyroRecord()
    assert record.mean(0, PERIOD_NS) is None
    record.add(0, 0.0)
    record.add(PERIOD_NS, None)
    record.add(2 * PERIOD_NS, 1.0)
    assert record.mean(0, 2 * PERIOD_NS) is None
    assert record.mean(PERIOD_NS, 2 * PERIOD_NS) == (1.0, 1.0)


@pytest.mark.parametrize(
    ("mounted", "axis"),
    [((0.0, 0.0, 1.0), (0, 0, 1)), ((math.pi, 0.0, 0.0), (0, 0, -1)), ((math.pi / 2, 0.0, 0.0), (0, 1, 0))],
)
def test_yaw_rate_is_read_along_the_bases_upward_axis(mounted, axis):
    assert up_axis(mounted) == pytest.approx(axis, abs=1e-12)
