import pytest
from hypothesis import given
from hypothesis import strategies as st

from tracked_bringup.bags import Playback, RawMessage, TopicChoice

STAMPS = st.lists(st.integers(0, 10**10), min_size=1, max_size=30).map(sorted)


def messages(stamps):
    return iter([RawMessage(stamp, "/a", bytes([index])) for index, stamp in enumerate(stamps)])


@given(stamps=STAMPS, rate=st.floats(0.1, 10.0), step_s=st.floats(0.001, 2.0))
def test_every_message_is_played_once_in_order_and_never_early(stamps, rate, step_s):
    playback, now_s, played = Playback(messages(stamps), rate), 100.0, []
    while not playback.finished:
        while (message := playback.due(now_s)) is not None:
            assert (message.stamp_ns - stamps[0]) * 1e-9 / rate <= now_s - 100.0 + 1e-6
            played.append(message)
        reached_ns = playback.time_ns(now_s)
        assert reached_ns is not None and reached_ns >= (played[-1].stamp_ns if not playback.finished else 0)
        now_s += max(step_s, playback.wait_s(now_s)) if not playback.finished else 0.0
    assert [message.stamp_ns for message in played] == stamps
    assert playback.due(now_s) is None and playback.wait_s(now_s) > 60.0


def test_nothing_is_late_because_the_start_was():
    playback = Playback(messages([5, 10**9]), 1.0)
    assert playback.time_ns(0.0) is None
    assert playback.due(1000.0) is not None and playback.due(1000.0) is None
    assert playback.wait_s(1000.0) == pytest.approx(1.0)


def test_time_does_not_overtake_the_next_message():
    playback = Playback(messages([0, 10**9]), 1.0)
    playback.due(0.0)
    assert playback.time_ns(0.4) == 400_000_000 and playback.time_ns(3.0) == 10**9


def test_no_messages_are_played_at_once():
    assert Playback(iter([]), 1.0).finished


@pytest.mark.parametrize(
    ("wanted", "unwanted", "inside", "outside"),
    [
        (["/odom"], [], ["/odom"], ["/odom2", "/r/odom"]),
        (["odom"], [], ["/robot/odom"], ["/odom"]),
        ([".*"], [], ["/robot/scan"], ["/scan"]),
        (["/.*"], ["/camera/.*"], ["/scan"], ["/camera/image"]),
        (["/cmd_vel.*", "/odom", ""], [""], ["/cmd_vel_nav", "/odom"], ["/tf"]),
    ],
)
def test_topics_are_chosen_by_whole_names_or_expressions(wanted, unwanted, inside, outside):
    choice = TopicChoice(wanted, unwanted, "/robot")
    assert all(topic in choice for topic in inside)
    assert not any(topic in choice for topic in outside)


@pytest.mark.parametrize(("wanted", "said"), [(["["], "'\\['"), ([""], "no topic"), (["*"], "neither a topic nor")])
def test_a_choice_that_means_nothing_is_refused(wanted, said):
    with pytest.raises(ValueError, match=said):
        TopicChoice(wanted)
