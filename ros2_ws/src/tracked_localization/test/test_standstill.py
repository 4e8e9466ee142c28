import math

import numpy as np
import pytest

from tracked_localization.belt_pair import BeltMotion
from tracked_localization.standstill import Standstill

PERIOD_NS = 1_000_000_000 // 120
BIAS_VARIANCE = 1e-6


@pytest.fixture
def run(settings):
    """``run(seconds, rate, belts)``: the standstill after that long; ``rate(time)`` is the gyro, noise excluded."""

    def play(seconds, rate=lambda _time: 0.0, belts=lambda _time: (0.0, 0.0), watch=None):
        standstill, random = Standstill(settings), np.random.default_rng(3)
        for index in range(round(seconds * 120)):
            time = index / 120.0
            if index % 2 == 0 and belts is not None:
                standstill.add_belts(BeltMotion(index * PERIOD_NS, 1 / 60, *belts(time), ()))
            reading = rate(time)
            noisy = None if reading is None else reading + 0.01 * random.standard_normal()
            standstill.add_gyro(index * PERIOD_NS, noisy, 0.0, BIAS_VARIANCE)
            if watch:
                watch(time, standstill)
        return standstill

    return play


def test_quiet_belts_and_gyro_are_a_standstill(run):
    begun = []
    assert run(1.0, watch=lambda time, state: state.standing and begun.append(time)).standing
    assert 0.2 < begun[0] < 0.5


def test_belts_that_count_are_none(run):
    assert not run(1.0, belts=lambda _time: (0.0004, 0.0004)).standing
    assert not run(1.0, belts=lambda _time: (0.0, 0.0) if _time < 0.9 else (0.001, 0.0)).standing


def test_counter_that_flickers_by_one_tick_does_not_move(run):
    flicker = iter([0.0002, -0.0002] * 100)
    assert run(1.0, belts=lambda _time: (0.0, next(flicker))).standing


def test_turning_body_is_none(run):
    assert not run(1.0, rate=lambda time: 0.8 * math.sin(3.0 * time)).standing


def test_body_that_sways_on_its_belts_is_no_new_bias(run):
    found = []
    run(
        3.0,
        rate=lambda time: 0.05 * math.sin(2.0 * math.pi * time / 1.2),
        watch=lambda _time, state: found.append(state.new_bias_radps),
    )
    assert not any(found)


@pytest.mark.parametrize("rate", [0.08, 0.3])
def test_steady_reading_at_rest_is_a_new_bias_within_half_a_second(run, rate):
    found = []
    run(0.6, rate=lambda _time: rate, watch=lambda time, state: state.new_bias_radps and found.append(time))
    assert found and found[0] <= 0.5


def test_without_gyro_the_belts_decide(run):
    assert run(1.0, rate=lambda _time: None).standing


def test_silent_or_refused_belts_bear_no_witness(run):
    assert not run(1.0, belts=None).standing
    assert not run(1.0, belts=lambda _time: (None, 0.0)).standing


def test_starts_into_turns_after_rests_do_not_move_the_gyro_bias(odometry_filter, crawler, feed, robot):
    def drive(time_s):
        return (0.0, 1.0 if time_s > 3.0 and time_s % 2.0 > 1.2 else 0.0)

    made = crawler(drive, 3)
    feed(odometry_filter, list(made.run(3.0)))
    feed(odometry_filter, list(made.run(30.0)))
    assert abs(odometry_filter.gyro_bias_radps - made.bias_radps) < 0.001
