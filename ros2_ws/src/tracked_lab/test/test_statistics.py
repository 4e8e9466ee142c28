import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from tracked_lab.statistics import latest_median, median_interval, reduction_percent


def test_the_interval_holds_the_median_as_often_as_it_says():
    generator = np.random.default_rng(0)
    hits = []
    for seed in range(300):
        interval = median_interval(generator.exponential(1.0, 40), seed)
        hits.append(interval.low <= np.log(2.0) <= interval.high)
    assert 0.91 < np.mean(hits) < 0.985


@given(hnp.arrays(np.float64, st.integers(1, 30), elements=st.floats(-1e6, 1e6)))
def test_the_median_lies_in_its_interval(values):
    interval = median_interval(values)
    assert interval.low <= interval.median <= interval.high and interval.count == len(values)


def test_pairs_are_compared_seed_by_seed():
    baseline, other = np.array([1.0, 10.0, 100.0]), np.array([0.5, 4.0, 60.0])
    assert reduction_percent(baseline, other).median == pytest.approx(50.0)


def test_what_is_missing_leaves_its_pair_out():
    lower = reduction_percent(np.array([1.0, np.nan, 0.0, 2.0]), np.array([0.5, 1.0, 1.0, 1.0]))
    assert lower.count == 2 and lower.median == pytest.approx(50.0)


def test_no_pair_at_all_or_unequal_numbers_are_refused():
    with pytest.raises(ValueError, match="finite"):
        reduction_percent(np.array([np.nan]), np.array([1.0]))
    with pytest.raises(ValueError, match="pairs"):
        reduction_percent(np.ones(2), np.ones(3))


def test_equal_seeds_give_equal_intervals():
    values = np.random.default_rng(1).normal(size=25)
    assert median_interval(values, 3) == median_interval(values, 3)


def test_what_never_came_counts_as_latest_and_not_as_absent():
    times = np.array([0.4, 0.6, 0.8, np.inf, np.nan])
    found = latest_median(times)
    assert found.median == pytest.approx(0.7) and found.high == np.inf and found.count == 4
    assert latest_median(np.array([0.4, np.inf])) is None and latest_median(np.array([np.nan])) is None
