import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from scipy import signal

from tracked_report.signals import derivative, low_pass, peak_to_peak, percentile, root_mean_square, sample_rate

SAMPLES = hnp.arrays(np.float64, st.integers(1, 50), elements=st.floats(-1e3, 1e3))


@given(SAMPLES, st.floats(-1e3, 1e3))
def test_peak_to_peak_does_not_see_an_offset(samples, offset):
    assert peak_to_peak(samples + offset) == pytest.approx(peak_to_peak(samples), abs=1e-9)


@given(SAMPLES, st.floats(-1e3, 1e3))
def test_root_mean_square_scales_with_the_signal(samples, factor):
    assert root_mean_square(factor * samples) == pytest.approx(abs(factor) * root_mean_square(samples), abs=1e-9)


@given(SAMPLES)
def test_root_mean_square_lies_between_mean_and_peak(samples):
    rms = root_mean_square(samples)
    assert abs(samples.mean()) - 1e-9 <= rms <= np.abs(samples).max() + 1e-9


def test_huge_and_tiny_samples_survive_the_squares():
    assert root_mean_square(np.array([1e200, 1e200])) == pytest.approx(1e200)
    assert root_mean_square(np.array([1e-200, 1e-200])) == pytest.approx(1e-200)


def test_no_samples_make_no_figure():
    nothing = np.zeros(0)
    assert all(math.isnan(figure(nothing)) for figure in (peak_to_peak, root_mean_square, sample_rate))
    assert math.isnan(percentile(nothing, 50.0))
    assert derivative(np.zeros(1), np.zeros(1))[0].size == 0


def test_low_pass_is_the_second_order_butterworth():
    samples = np.random.default_rng(1).normal(size=400)
    b, a = signal.butter(2, 50.0, fs=960.0)
    expected, _ = signal.lfilter(b, a, samples, zi=signal.lfilter_zi(b, a) * samples[0])
    assert low_pass(samples, 960.0, 50.0) == pytest.approx(expected, abs=1e-9)


def test_low_pass_leaves_samples_alone_that_hold_nothing_above_it():
    samples = np.array([1.0, -1.0, 1.0])
    assert low_pass(samples, 60.0, 50.0).tolist() == samples.tolist()
    assert low_pass(np.zeros(0), 960.0, 50.0).size == 0


@given(st.floats(-1e6, 1e6))
def test_low_pass_keeps_a_constant(value):
    assert low_pass(np.full(20, value), 960.0, 50.0) == pytest.approx(value, rel=1e-9, abs=1e-9)


@pytest.mark.parametrize(("rate", "cutoff"), [(0.0, 50.0), (math.nan, 50.0), (960.0, 0.0), (960.0, math.inf)])
def test_low_pass_refuses_impossible_frequencies(rate, cutoff):
    with pytest.raises(ValueError, match="must be positive"):
        low_pass(np.ones(3), rate, cutoff)
