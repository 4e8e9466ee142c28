import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tracked_navigation.rest_to_rest import RestToRest

POSITIVE = st.floats(0.01, 20.0)


@given(distance=st.floats(0.0, 50.0), cruise=POSITIVE, acceleration=POSITIVE)
def test_motion_starts_and_ends_at_rest_within_its_rates(distance: float, cruise: float, acceleration: float) -> None:
    law = RestToRest(distance, cruise, acceleration, 0.05)
    times = np.linspace(0.0, law.duration_s, 2001)
    covered, rate = law.at(times)
    assert covered[0] == 0.0 and covered[-1] == pytest.approx(distance, rel=1e-9, abs=1e-12)
    assert rate[0] == pytest.approx(0.0, abs=1e-12) and rate[-1] == pytest.approx(0.0, abs=1e-12)
    assert np.all(np.diff(covered) >= -1e-12)
    assert np.max(rate) <= cruise * (1.0 + 1e-9)
    if law.duration_s > 0.0:
        assert np.max(np.abs(np.diff(rate))) <= acceleration * (times[1] - times[0]) * (1.0 + 1e-6) + 1e-12
        assert law.duration_s / 0.05 == pytest.approx(law.steps)


def test_rate_is_the_derivative_of_the_distance() -> None:
    law = RestToRest(2.0, 0.4, 0.6, 0.05)
    times = np.linspace(0.0, law.duration_s, 200_001)
    covered, rate = law.at(times)
    assert np.gradient(covered, times)[1:-1] == pytest.approx(rate[1:-1], abs=1e-6)


def test_short_motion_never_reaches_its_cruise_rate() -> None:
    law = RestToRest(0.01, 1.0, 0.5, 0.05)
    assert law.cruise < 0.1


def test_no_distance_takes_no_time() -> None:
    assert RestToRest(0.0, 1.0, 1.0, 0.05).duration_s == 0.0


@pytest.mark.parametrize(
    "wrong", [(-1.0, 1, 1, 1), (1, 0.0, 1, 1), (1, 1, -1.0, 1), (1, 1, 1, 0.0), (math.nan, 1, 1, 1)]
)
def test_impossible_motion_is_refused(wrong: tuple[float, float, float, float]) -> None:
    with pytest.raises(ValueError, match="positive"):
        RestToRest(*wrong)
