import math

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from tracked_localization.slip import SlipEstimator, SlipSettings, slip_at, track_slip, unknown_slip
from tracked_types import Slip

GAUGE = 0.36
SPEEDS = st.floats(-0.75, 0.75)
RATES = st.floats(-1.5, 1.5)


def thesis_slip(left, right, rate):
    """(5.2.8)-(5.2.11) as printed, by way of the slip ratios of both tracks."""
    sign = math.copysign(1.0, left * right)
    ratio_right = (right - left - GAUGE * rate) / (right + left * sign)
    ratio_left = (left - right + GAUGE * rate) / (left + right * sign)
    return -(right * ratio_right + left * ratio_left) / 2.0, (left * ratio_left - right * ratio_right) / GAUGE


@pytest.fixture
def estimator(robot):
    return SlipEstimator(SlipSettings.from_robot(robot))


@given(SPEEDS, SPEEDS, RATES)
def test_equals_the_thesis_wherever_its_ratios_exist(left, right, rate):
    assume(abs(left) > 1e-3 and abs(right) > 1e-3)
    assert track_slip(left, right, rate, GAUGE) == pytest.approx(thesis_slip(left, right, rate), abs=1e-9)


@given(SPEEDS, SPEEDS, RATES)
def test_yaw_part_is_what_the_belts_turn_less_than_the_body(left, right, rate):
    speed, yaw_rate = track_slip(left, right, rate, GAUGE)
    assert yaw_rate == pytest.approx(rate - (right - left) / GAUGE)
    assert abs(speed) <= 0.5 * GAUGE * abs(yaw_rate) + 1e-12


def test_opposite_speeds_are_not_singular():
    assert track_slip(-0.2, 0.2, 0.9, GAUGE) == pytest.approx((0.0, 0.9 - 0.4 / GAUGE))


@pytest.mark.parametrize(("left", "right"), [(0.0, 0.3), (0.3, 0.0), (0.0, -0.3)])
def test_one_stopped_track_is_not_singular(left, right):
    speed, yaw_rate = track_slip(left, right, 0.5, GAUGE)
    assert math.isfinite(speed) and abs(speed) == pytest.approx(0.5 * GAUGE * abs(yaw_rate))


def test_slip_of_both_tracks_alike_cannot_be_seen():
    assert track_slip(0.4, 0.4, 0.0, GAUGE) == (0.0, 0.0)


def test_standstill_is_unknown_and_zero(estimator):
    slip = estimator.update(5, 0.01, -0.01, 0.3, 1e-4, 1 / 60)
    assert slip == unknown_slip(5)
    assert not slip.known


def test_rounding_to_ticks_is_in_the_variance(estimator, robot):
    slip = estimator.update(5, 0.2, 0.4, 0.3, 5e-5, 1 / 60)
    rounding = 2.0 * (robot.tracks.encoder_tick_m * 60.0) ** 2 / 6.0 / robot.tracks.gauge_m**2
    assert slip.known
    assert slip.yaw_rate_variance == pytest.approx(5e-5 + rounding)
    assert slip.speed_variance > 0.0


def test_old_slip_is_unknown_slip():
    slip = Slip(10**9, 0.01, 0.1, 1e-4, 1e-4, known=True)
    assert slip_at(slip, 10**9 + 5 * 10**6, 0.1).yaw_rate_radps == 0.1
    assert slip_at(slip, 10**9 + 5 * 10**6, 0.1).stamp_ns == 10**9 + 5 * 10**6
    assert not slip_at(slip, 2 * 10**9, 0.1).known


def test_threshold_out_of_range_is_named(robot):
    with pytest.raises(ValueError, match="standstill_track_speed_mps"):
        SlipSettings.from_robot(robot, standstill_track_speed_mps=-1.0)
