import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tracked_localization.adaptive_noise import AdaptiveNoise


@given(st.lists(st.floats(0.0, 1e12), max_size=50))
def test_intensity_stays_within_its_bounds(surprises):
    noise = AdaptiveNoise(1e-3, 10.0, rate=0.2)
    for surprise in surprises:
        noise.observe(surprise)
        assert 0.999e-3 <= noise.intensity <= 10.001


def test_surprise_raises_and_calm_lowers_the_intensity():
    noise = AdaptiveNoise(1e-6, 100.0, rate=0.1)
    before = noise.intensity
    noise.observe(9.0)
    raised = noise.intensity
    for _ in range(30):
        noise.observe(0.0)
    assert noise.intensity < before < raised


def test_mean_of_the_normalised_squares_settles_at_one():
    random, noise, squares = np.random.default_rng(1), AdaptiveNoise(1e-6, 1e6, rate=0.1), []
    for index in range(4000):
        liveliness = 100.0 if (index // 200) % 2 else 0.01
        squares.append((random.standard_normal() ** 2) * (1.0 + liveliness) / (1.0 + noise.intensity))
        noise.observe(squares[-1])
    assert np.mean(squares) == pytest.approx(1.0, abs=0.05)


def test_unwatched_motion_may_do_its_worst():
    noise = AdaptiveNoise(1e-3, 10.0, rate=0.2)
    noise.expect_anything()
    assert math.isclose(noise.intensity, 10.0)
