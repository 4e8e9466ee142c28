from hypothesis import given
from hypothesis import strategies as st

from tracked_types import StampOrder, clock_set_back, to_nanoseconds

HALF_SECOND_NS = to_nanoseconds(0.5)
stamps = st.integers(min_value=0, max_value=2**62)


def test_a_first_stamp_advances_from_just_before_itself() -> None:
    order = StampOrder()
    assert order.advance(0)
    assert (order.previous_ns, order.latest_ns) == (-1, 0)


def test_repeated_and_late_stamps_are_ignored_and_counted() -> None:
    order = StampOrder()
    accepted = [order.advance(stamp) for stamp in (HALF_SECOND_NS, HALF_SECOND_NS, 1, 0, HALF_SECOND_NS + 1)]
    assert accepted == [True, False, False, False, True]
    assert order.ignored == 3
    assert (order.previous_ns, order.latest_ns) == (HALF_SECOND_NS, HALF_SECOND_NS + 1)


def test_a_clock_that_was_set_back_starts_anew() -> None:
    order = StampOrder()
    order.advance(HALF_SECOND_NS + 5)
    assert not order.jumps_back(5) and order.jumps_back(4)
    assert order.advance(4)
    assert (order.previous_ns, order.latest_ns, order.ignored) == (3, 4, 0)


def test_before_any_stamp_no_clock_was_set_back() -> None:
    assert not clock_set_back(None, -HALF_SECOND_NS)


@given(st.lists(stamps, max_size=20))
def test_accepted_stamps_only_grow_between_resets(sequence: list[int]) -> None:
    order = StampOrder()
    for stamp in sequence:
        reset = order.jumps_back(stamp)
        latest = order.latest_ns
        if order.advance(stamp):
            assert latest is None or reset or latest == order.previous_ns < stamp
        else:
            assert order.latest_ns == latest
