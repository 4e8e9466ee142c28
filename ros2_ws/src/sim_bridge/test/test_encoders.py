import pytest
from hypothesis import given
from hypothesis import strategies as st

from sim_bridge.sensors.encoders import BeltEncoders

TICK_M, RATE_HZ = 0.0002, 60


@given(st.lists(st.tuples(st.floats(-5.0, 5.0), st.floats(-5.0, 5.0)), min_size=1, max_size=20))
def test_travel_is_whole_ticks_just_below_and_speeds_add_up_to_it(travels):
    encoders = BeltEncoders(TICK_M, RATE_HZ)
    left_sum = right_sum = 0.0
    for left, right in travels:
        sample = encoders.update(left, right, 0)
        assert -1e-9 <= left - sample.left_travel_m <= TICK_M + 1e-9
        assert sample.right_travel_m / TICK_M == pytest.approx(round(sample.right_travel_m / TICK_M), abs=1e-6)
        left_sum += sample.left_speed_mps / RATE_HZ
        right_sum += sample.right_speed_mps / RATE_HZ
    assert left_sum == pytest.approx(sample.left_travel_m, abs=1e-9)
    assert right_sum == pytest.approx(sample.right_travel_m, abs=1e-9)


def test_motion_below_one_tick_is_not_seen():
    encoders = BeltEncoders(TICK_M, RATE_HZ)
    sample = encoders.update(0.9 * TICK_M, 0.1 * TICK_M, 3)
    assert (sample.left_travel_m, sample.right_speed_mps, sample.stamp_ns) == (0.0, 0.0, 3)


@given(st.floats(-0.75, 0.75))
def test_steady_speed_reads_as_whole_ticks_per_period_around_it(speed):
    encoders = BeltEncoders(TICK_M, RATE_HZ)
    encoders.update(0.0, 0.0, 0)
    resolution = TICK_M * RATE_HZ
    for k in range(1, 30):
        reading = encoders.update(speed * k / RATE_HZ, 0.0, k).left_speed_mps
        assert abs(reading - speed) < resolution * (1.0 + 1e-6)
        assert reading / resolution == pytest.approx(round(reading / resolution), abs=1e-6)
