from hypothesis import given
from hypothesis import strategies as st

from tracked_localization.sample_buffer import Arrival, SampleBuffer

FAST, SLOW = 0, 1
MS = 1_000_000
FAST_NS, SLOW_NS = 1_000_000_000 // 120, 1_000_000_000 // 60


def make_buffer(patience_s=0.012):
    return SampleBuffer((120, 60), patience_s, 0.1)


def fast_and_slow(count, start_ns=0):
    """Samples of both streams in order of their stamps, ``count`` of the fast one."""
    samples = []
    for index in range(1, count + 1):
        samples.append((FAST, start_ns + index * FAST_NS))
        if index % 2 == 0:
            samples.append((SLOW, start_ns + index * FAST_NS))
    return samples


def feed(buffer, samples):
    released = []
    for stream, stamp in samples:
        buffer.add(stream, stamp, stamp)
        released += [(item.stream, item.stamp_ns) for item in buffer.release()]
    return released


def test_samples_come_out_once_both_streams_have_spoken():
    assert feed(make_buffer(), fast_and_slow(20)) == fast_and_slow(20)


@given(st.data())
def test_order_of_arrival_within_the_patience_does_not_matter(data):
    samples = fast_and_slow(30)
    delays = [0] + [data.draw(st.integers(0, 11)) * MS for _ in samples[1:]]
    shuffled = [
        sample for _, sample in sorted(zip(delays, samples, strict=True), key=lambda pair: pair[0] + pair[1][1])
    ]
    released = feed(make_buffer(), shuffled)
    # The newest samples may still wait for their turn.
    assert released == samples[: len(released)]
    assert len(released) >= len(samples) - 9


def test_missing_sample_is_awaited_for_the_patience_only():
    buffer = make_buffer()
    samples = fast_and_slow(20)
    lost = (FAST, 11 * FAST_NS)
    released = feed(buffer, [sample for sample in samples if sample != lost])
    assert released == [sample for sample in samples if sample != lost]


def test_sample_behind_its_turn_is_late():
    buffer = make_buffer()
    feed(buffer, [sample for sample in fast_and_slow(20) if sample != (FAST, 11 * FAST_NS)])
    assert buffer.add(FAST, 11 * FAST_NS, None) is Arrival.LATE


def test_same_stamp_twice_is_a_duplicate_before_and_after_its_turn():
    buffer = make_buffer()
    buffer.add(FAST, FAST_NS, None)
    assert buffer.add(FAST, FAST_NS, None) is Arrival.DUPLICATE
    feed(buffer, fast_and_slow(10))
    assert buffer.add(FAST, 10 * FAST_NS, None) is Arrival.DUPLICATE


def test_silent_stream_is_not_waited_for():
    buffer = make_buffer()
    released = feed(buffer, [(FAST, index * FAST_NS) for index in range(1, 60)])
    assert buffer.silent(SLOW)
    assert released[-1] == (FAST, 59 * FAST_NS)


def test_one_stamp_from_the_future_is_held_and_forgotten():
    buffer = make_buffer()
    feed(buffer, fast_and_slow(10))
    assert buffer.add(FAST, 10**15, None) is Arrival.HELD
    assert buffer.add(FAST, 11 * FAST_NS, None) is Arrival.QUEUED_AFTER_GARBAGE
    assert feed(buffer, fast_and_slow(20)[15:]) == fast_and_slow(20)[15:]


def test_clock_that_jumps_back_starts_a_new_time_line_after_three_samples():
    buffer = make_buffer()
    feed(buffer, fast_and_slow(600))
    arrivals = [buffer.add(FAST, index * FAST_NS, index) for index in (1, 2, 3)]
    assert arrivals == [Arrival.LATE, Arrival.LATE, Arrival.TIME_JUMPED]
    released = feed(buffer, [(SLOW, 2 * FAST_NS), (FAST, 4 * FAST_NS), (SLOW, 4 * FAST_NS)])
    assert released[:3] == [(FAST, FAST_NS), (FAST, 2 * FAST_NS), (SLOW, 2 * FAST_NS)]


def test_delayed_stream_is_late_and_no_jump_of_the_clock():
    buffer = make_buffer()
    samples = fast_and_slow(120)
    feed(buffer, [sample for sample in samples if sample[0] == SLOW])
    arrivals = {buffer.add(*sample, None) for sample in samples if sample[0] == FAST and sample[1] < 80 * FAST_NS}
    assert arrivals == {Arrival.LATE}


def test_lost_samples_show_in_the_loss():
    buffer = make_buffer()
    feed(buffer, fast_and_slow(60))
    assert buffer.loss(FAST) == 0.0
    feed(buffer, [sample for sample in fast_and_slow(160)[90:] if sample[0] == SLOW or sample[1] // FAST_NS % 2])
    assert buffer.loss(FAST) > 0.3
    assert buffer.loss(SLOW) == 0.0


@given(st.lists(st.tuples(st.integers(0, 1), st.integers(-(10**12), 10**12)), max_size=60))
def test_nonsense_stamps_never_come_out_of_order(samples):
    buffer = make_buffer()
    newest = None
    for stream, stamp in samples:
        if buffer.add(stream, stamp, None) is Arrival.TIME_JUMPED:
            newest = None
        for item in buffer.release():
            assert newest is None or item.stamp_ns >= newest
            newest = item.stamp_ns
