import math

import pytest

from tracked_localization.belt_gate import BeltGate
from tracked_localization.belt_pair import BeltPair
from tracked_localization.health import Fault
from tracked_types import LEFT_TRACK, RIGHT_TRACK, TrackSample

PERIOD_NS = 1_000_000_000 // 60
TICK_M = 0.0002


def counted(travels_m):
    return [math.floor(travel / TICK_M) * TICK_M for travel in travels_m]


def rolling(speed_mps, count, start_m=0.0):
    return [start_m + speed_mps * index / 60.0 for index in range(count)]


@pytest.fixture
def gate(settings):
    return BeltGate(settings)


def judge(gate, travels_m):
    return [gate.update(index * PERIOD_NS, travel) for index, travel in enumerate(counted(travels_m))]


def test_steady_and_accelerating_belts_are_believed(gate):
    travels = rolling(0.3, 30)
    speed = 0.3
    for _ in range(30):
        speed = max(speed - 2.9 / 60.0, -0.5)
        travels.append(travels[-1] + speed / 60.0)
    readings = judge(gate, travels)
    assert all(reading.travel_m is not None for reading in readings[1:])


def test_belt_that_stops_dead_is_stuck_until_it_counts_again(gate):
    readings = judge(gate, rolling(0.35, 30) + [rolling(0.35, 30)[-1]] * 60)
    assert all(reading.travel_m is None for reading in readings[30:])
    assert {reading.fault for reading in readings[31:]} == {Fault.STUCK}
    travels = counted(rolling(0.35, 20, start_m=rolling(0.35, 30)[-1]))
    again = [gate.update((90 + index) * PERIOD_NS, travel) for index, travel in enumerate(travels)]
    assert all(reading.travel_m is not None for reading in again[2:])


def test_leap_of_the_counter_is_refused_and_named_and_forgotten(gate):
    travels = rolling(0.3, 20) + rolling(0.3, 20, start_m=0.5)
    readings = judge(gate, travels)
    assert readings[20].travel_m is None
    assert readings[20].fault is Fault.JUMP
    assert all(reading.fault is None and reading.travel_m is not None for reading in readings[21:])


def test_single_shock_is_refused_without_blame(gate):
    travels = rolling(0.3, 20)
    travels += rolling(0.46, 5, start_m=travels[-1] + 0.46 / 60.0)
    readings = judge(gate, travels)
    assert readings[20].travel_m is None
    assert all(reading.fault is None for reading in readings)


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_numbers_that_are_none_are_named(gate, value):
    judge(gate, rolling(0.3, 5))
    assert gate.update(5 * PERIOD_NS, value).fault is Fault.NOT_FINITE
    assert gate.update(6 * PERIOD_NS, rolling(0.3, 7)[6]).fault is None


def run_pair(settings, left_mps, right_mps, gyro_radps, count=60):
    pair = BeltPair(settings)
    lefts, rights = counted(rolling(left_mps, count)), counted(rolling(right_mps, count))
    faults = {}
    for index, (left, right) in enumerate(zip(lefts, rights, strict=True)):
        sample = TrackSample(index * PERIOD_NS, left, right, left_mps, right_mps)
        for fault in pair.update(sample, gyro_radps).faults:
            faults.setdefault(fault, index / 60.0)
    return faults


def test_counter_stuck_since_rest_is_betrayed_by_a_body_that_does_not_pivot(settings):
    faults = run_pair(settings, 0.0, 0.3, gyro_radps=0.0)
    assert set(faults) == {(LEFT_TRACK, Fault.STUCK)}
    assert faults[LEFT_TRACK, Fault.STUCK] < 0.5
    assert set(run_pair(settings, 0.3, 0.0, gyro_radps=0.05)) == {(RIGHT_TRACK, Fault.STUCK)}


def test_pivot_on_a_stopped_track_blames_nobody(settings):
    assert not run_pair(settings, 0.0, 0.3, gyro_radps=0.8 * 0.3 / settings.gauge_m)


def test_both_counters_stuck_are_betrayed_by_a_turn(settings):
    faults = run_pair(settings, 0.0, 0.0, gyro_radps=0.6)
    assert set(faults) == {(LEFT_TRACK, Fault.STUCK), (RIGHT_TRACK, Fault.STUCK)}


def test_without_gyro_nobody_is_cross_checked(settings):
    assert not run_pair(settings, 0.0, 0.3, gyro_radps=None)
