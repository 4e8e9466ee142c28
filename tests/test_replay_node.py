"""Recordings played into the graph by the real executable."""

import time

import numpy as np
import pytest
from nav_msgs.msg import Odometry
from rclpy.qos import QoSProfile
from rclpy.serialization import deserialize_message, serialize_message
from rosgraph_msgs.msg import Clock
from std_msgs.msg import Bool, String

from tests.support.graph_process import GraphProcess
from tracked_bringup.bags import BagReader, BagWriter, message_definition

START_LIMIT_S, RUN_LIMIT_S, ATTEMPTS = 60.0, 90.0, 3
DEEP = QoSProfile(depth=5000)
BEGUN_NS = 1_700_000_000 * 10**9
PERIOD_NS = 20_000_000


@pytest.fixture
def bag(tmp_path):
    """Fifty numbers, 50 a second, and a fact with the tenth of them."""
    writer = BagWriter(tmp_path / "bag")
    for topic, kind in (("/numbers", "String"), ("/fact", "Bool")):
        type_name = f"std_msgs/msg/{kind}"
        writer.add_topic(topic, type_name, message_definition(type_name), "", [])
    for index in range(50):
        stamp_ns = BEGUN_NS + index * PERIOD_NS
        writer.write("/numbers", stamp_ns, serialize_message(String(data=str(index))))
        if index == 10:
            writer.write("/fact", stamp_ns, serialize_message(Bool(data=True)))
    writer.close()
    return tmp_path / "bag"


@pytest.fixture
def play(start_node):
    """Starts a replay with these parameters; further words follow them."""

    def start(bag, *parameters, more=()):
        given = (word for parameter in (f"bag:={bag}", *parameters) for word in ("-p", parameter))
        return start_node("tracked_bringup", "replay", "--ros-args", *given, *more)

    return start


def texts(heard):
    return [int(message.data) for message in heard]


def test_everything_is_played_once_readers_are_there_with_the_time_of_recording_and_then_it_ends(bag, play, probe):
    process = play(bag, "rate:=2.0", "wait_for_readers:=[numbers, fact]", more=("-r", "numbers:=old/numbers"))
    probe.wait_until(lambda: "replay" in probe.node.get_node_names(), timeout_s=START_LIMIT_S, what="the replay")
    probe.spin(0.3)
    clock, facts = probe.collect(Clock, "clock", DEEP), probe.collect(Bool, "fact", DEEP)
    numbers, arrived = [], []

    def note(message):
        numbers.append(message)
        arrived.append(time.monotonic())

    probe.node.create_subscription(String, "old/numbers", note, DEEP)
    probe.wait_until(lambda: len(numbers) == 50, what="fifty numbers")
    assert process.wait() == 0
    assert "51 messages played" in process.output
    assert texts(numbers) == list(range(50)) and len(facts) == 1
    assert arrived[-1] - arrived[0] > 0.4, "not all at once"
    stamps = [message.clock.sec * 10**9 + message.clock.nanosec for message in clock]
    assert len(stamps) > 5 and stamps == sorted(stamps)
    assert stamps[0] >= BEGUN_NS and stamps[-1] <= BEGUN_NS + 50 * PERIOD_NS


def test_a_part_of_some_topics_is_played_again_and_again(bag, play, probe):
    numbers, clock = probe.collect(String, "numbers", DEEP), probe.collect(Clock, "clock", DEEP)
    process = play(
        bag,
        "topics:=[num.*]",
        "start_s:=0.4",
        "end_s:=0.5",
        "loop:=true",
        "clock:=false",
        "wait_for_readers:=[numbers]",
    )
    probe.wait_until(lambda: len(numbers) > 12, timeout_s=START_LIMIT_S, what="the third round")
    assert texts(numbers)[:11] == [20, 21, 22, 23, 24] * 2 + [20]
    assert "fact" not in dict(probe.node.get_topic_names_and_types()) and not clock
    assert process.stop() == 0


def test_what_it_cannot_play_is_one_sentence(bag, play, tmp_path):
    (tmp_path / "cut.mcap").write_bytes((bag / "bag.mcap").read_bytes()[:1000])
    other = BagWriter(tmp_path / "other")
    other.add_topic("/alien", "no_such_msgs/msg/Alien", "", "", [])
    other.write("/alien", 0, b"x")
    other.close()
    changed = BagWriter(tmp_path / "changed")
    changed.add_topic("/text", "std_msgs/msg/String", "string data\nint8 more\n", "", [])
    changed.write("/text", 0, b"x")
    changed.close()
    begun = {
        "cut.mcap was cut off": play(tmp_path / "cut.mcap"),
        "no topic is /odom; there are /fact, /numbers": play(bag, "topics:=[odom]"),
        "wait_for_readers names /odom, which is not played": play(bag, "wait_for_readers:=[odom]"),
        "nobody reads /numbers after 0.2 s": play(bag, "wait_for_readers:=[numbers]", "wait_s:=0.2"),
        "type no_such_msgs/msg/Alien is not installed here": play(tmp_path / "other"),
        "its std_msgs/msg/String is another one here": play(tmp_path / "changed"),
    }
    for said, process in begun.items():
        assert process.wait(START_LIMIT_S) in (1, 2), said
        (line,) = process.output.strip().splitlines()
        assert "FATAL" in line and said in line


def test_sensors_of_a_recorded_drive_give_a_fresh_filter_the_odometry_of_the_drive(
    play, start_node, probe, ros_domain, tmp_path
):
    topics = "mcap_recorder.topics:=[clock, imu/data, joint_states, odom, tf_static]"
    changes = ("time:=lock_step", "duration_s:=3.5", "nodes.mcap_recorder:=true", "nodes.recorder:=false", topics)
    graph = GraphProcess(ros_domain, tmp_path, "track", *changes)
    try:
        assert graph.wait(RUN_LIMIT_S) == 0, graph.output
    finally:
        graph.end()
    recorded = tmp_path / "out" / "track" / "double_bag"
    with BagReader(recorded) as bag:
        assert bag.topics["/tf_static"].latched
        driven = [deserialize_message(message.data, Odometry) for message in bag.messages(["/odom"])]
    errors = []
    while not errors or (max(errors) >= 1e-9 and len(errors) < ATTEMPTS):
        errors.append(largest_difference(driven, replayed_odometry(play, start_node, probe, recorded)))
    # The same samples give the same estimates; a machine that halts the filter for long makes samples late.
    assert min(errors) < 1e-9
    first, last = table(driven[:1]), table(driven[-1:])
    assert np.hypot(*np.subtract(*first.values(), *last.values())[:2]) > 0.05, "it went somewhere"


def replayed_odometry(play, start_node, probe, recorded):
    """What a filter that has just been started makes of the recorded sensors."""
    replayed = []
    reader = probe.node.create_subscription(Odometry, "odom", replayed.append, DEEP)
    given = ("use_sim_time:=true", "reliable_sensors:=true", "patience_s:=0.1")
    words = (word for parameter in given for word in ("-p", parameter))
    estimator = start_node("tracked_localization", "ekf", "--ros-args", *words)
    probe.wait_until(reader.get_publisher_count, timeout_s=START_LIMIT_S, what="the filter")
    sensors = ("topics:=[clock, imu/data, joint_states]", "wait_for_readers:=[imu/data, joint_states]")
    process = play(recorded, *sensors, "rate:=0.5")
    probe.wait_until(lambda: not process.is_running, timeout_s=RUN_LIMIT_S, what="the end of the replay")
    assert process.wait() == 0, process.output
    probe.spin(0.3)
    assert estimator.stop() == 0
    probe.node.destroy_subscription(reader)
    return replayed


def largest_difference(driven, replayed):
    """Between estimates of the same stamps; the newest may still have waited for samples that never came."""
    expected, found = table(driven), table(replayed)
    both = expected.keys() & found.keys()
    assert len(both) >= len(expected) - 10 > 100
    return max(np.abs(np.subtract(expected[stamp], found[stamp])).max() for stamp in both)


def table(messages):
    """Position, orientation and speeds by stamp."""
    return {
        (message.header.stamp.sec, message.header.stamp.nanosec): (
            message.pose.pose.position.x,
            message.pose.pose.position.y,
            message.pose.pose.orientation.z,
            message.twist.twist.linear.x,
            message.twist.twist.angular.z,
        )
        for message in messages
    }
