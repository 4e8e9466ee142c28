import pytest
from hypothesis import given
from hypothesis import strategies as st

from tracked_types import PeriodGrid

RATES = st.sampled_from([5, 10, 30, 60, 120, 480, 960])


@given(RATES, st.integers(0, 10**11))
def test_index_is_the_last_instant_at_or_before(rate, index):
    grid = PeriodGrid(rate)
    stamp = grid.stamp_ns(index)
    assert grid.index_at(stamp) == index
    assert grid.index_at(stamp - 1) == index - 1
    assert grid.is_instant(stamp)


@given(st.integers(0, 10**9))
def test_every_second_instant_of_the_faster_grid_is_one_of_the_slower(index):
    assert PeriodGrid(60).stamp_ns(2 * index) == PeriodGrid(30).stamp_ns(index)


@given(RATES, st.integers(0, 10**18), st.integers(-(10**9), 10**9))
def test_no_instant_is_lost_or_counted_twice(rate, start, step):
    grid = PeriodGrid(rate)
    middle, end = start + step // 2, start + step
    if step >= 0:
        assert [*grid.crossed(start, middle), *grid.crossed(middle, end)] == [*grid.crossed(start, end)]
    else:
        assert not grid.crossed(start, end)


@pytest.mark.parametrize("rate", [0, -5, 0.5])
def test_refuses_rates_that_are_not_positive_whole_numbers(rate):
    with pytest.raises(ValueError, match="rate_hz"):
        PeriodGrid(rate)
