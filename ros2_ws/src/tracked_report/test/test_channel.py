import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from tracked_report.channel import Channel


def channel(stamps, values, columns=("x_m", "yaw_rad")):
    return Channel(columns, np.array(stamps, np.int64), np.array(values, float), np.full(len(stamps), np.nan))


def test_headings_are_interpolated_along_the_shorter_arc():
    rows = channel([0, 100], [[0.0, 3.0], [1.0, -3.0]])
    x, yaw = rows.at(np.array([50]))[0]
    assert x == pytest.approx(0.5)
    assert abs(yaw) == pytest.approx(math.pi)


def test_ends_are_held_and_bad_rows_ignored():
    rows = channel([10, 20, 30], [[1.0, 0.0], [np.nan, 0.0], [3.0, 0.0]])
    assert rows.at(np.array([0, 20, 99]))[:, 0].tolist() == [1.0, 2.0, 3.0]


def test_cleaning_orders_rows_and_keeps_the_newest_of_equal_stamps():
    rows = channel([30, 10, 30, 20], [[1.0, 0.0], [2.0, 0.0], [3.0, 0.0], [np.inf, 0.0]]).clean()
    assert rows.stamps_ns.tolist() == [10, 30]
    assert rows.column("x_m").tolist() == [2.0, 3.0]


@given(
    hnp.arrays(np.int64, st.integers(0, 30), elements=st.integers(-(10**12), 10**12)),
    st.data(),
)
def test_cleaning_whatever_was_recorded_gives_finite_rows_in_strict_order(stamps, data):
    values = data.draw(hnp.arrays(np.float64, (len(stamps), 2), elements=st.floats(width=64)))
    rows = channel(stamps, values.reshape(-1, 2)).clean()
    assert np.all(np.diff(rows.stamps_ns) > 0)
    assert np.all(np.isfinite(rows.values))


def test_nothing_to_interpolate_is_a_clear_error():
    with pytest.raises(ValueError, match="no finite row"):
        channel([5], [[np.nan, 0.0]]).at(np.array([1]))


def test_shapes_that_do_not_fit_are_refused():
    with pytest.raises(ValueError, match=r"2 stamps need values \(2, 2\)"):
        channel([1, 2], [[1.0, 2.0]])
    with pytest.raises(ValueError, match="columns must differ"):
        channel([1], [[1.0, 2.0]], ("x_m", "x_m"))


def test_unknown_column_lists_the_known_ones():
    with pytest.raises(KeyError, match="x_m, yaw_rad"):
        channel([1], [[1.0, 2.0]]).column("z_m")
