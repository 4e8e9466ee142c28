"""Recordings of raw messages by the real executable: what is in them, and what is left when it is killed."""

import resource
import signal

import pytest
from diagnostic_msgs.msg import DiagnosticArray
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rclpy.serialization import deserialize_message
from rosbags.highlevel import AnyReader
from std_msgs.msg import String

from tracked_bringup.bags import BagReader

START_LIMIT_S = 60.0
LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
RELIABLE = QoSProfile(depth=1000, reliability=ReliabilityPolicy.RELIABLE)
LOSSY = QoSProfile(depth=1000, reliability=ReliabilityPolicy.BEST_EFFORT)


@pytest.fixture
def record(start_node, tmp_path, probe):
    """Starts a recorder of the topics below /kept and waits until it is there."""

    def start(*parameters, wait=True):
        process = start_node(
            *("tracked_bringup", "mcap_recorder", "--ros-args", "-p", f"folder:={tmp_path / 'bag'}"),
            *("-p", "topics:=[kept/.*]"),
            *(word for parameter in parameters for word in ("-p", parameter)),
        )
        if wait:
            probe.wait_until(
                lambda: "mcap_recorder" in probe.node.get_node_names(), timeout_s=START_LIMIT_S, what="the recorder"
            )
        return process

    return start


def texts(path, topic, **options):
    with BagReader(path, **options) as bag:
        return [deserialize_message(message.data, String).data for message in bag.messages([topic])]


def publish(probe, publisher, count, begin=0):
    """Numbers, each spun once so that nothing is lost on the way."""
    for number in range(begin, begin + count):
        publisher.publish(String(data=str(number)))
        probe.spin(0.005)


def numbers(count, begin=0):
    return [str(number) for number in range(begin, begin + count)]


def test_every_message_of_every_chosen_topic_is_kept_as_it_was_offered(record, probe, tmp_path):
    early = probe.node.create_publisher(String, "kept/latched", LATCHED)
    early.publish(String(data="fact"))
    process = record("exclude:=[kept/secret]")
    diagnostics = probe.collect(DiagnosticArray, "diagnostics", 100)
    steady = probe.publisher(String, "kept/steady", RELIABLE)
    probe.node.create_publisher(String, "kept/secret", RELIABLE).publish(String(data="no"))
    probe.node.create_publisher(String, "other", RELIABLE).publish(String(data="no"))
    publish(probe, steady, 20)
    late = probe.publisher(String, "kept/late", LOSSY)
    publish(probe, late, 20)
    told = [
        {value.key: value.value for value in status.values}
        for message in probe.wait_until(lambda: [m for m in diagnostics if _counts(m, "/kept/late")], what="counts")
        for status in message.status
        if status.name == "mcap_recorder: recording"
    ]
    assert told[-1]["/kept/steady"] == "20"
    assert process.stop() == 0
    assert "41 messages of 3 topics" in process.output and "20 /kept/late" in process.output
    assert texts(tmp_path / "bag", "/kept/latched") == ["fact"]
    assert texts(tmp_path / "bag", "/kept/steady") == texts(tmp_path / "bag", "/kept/late") == numbers(20)
    with AnyReader([tmp_path / "bag"]) as other:  # checks the recorded hashes against the recorded definitions
        qualities = {connection.topic: connection.ext.offered_qos_profiles[0] for connection in other.connections}
    assert set(qualities) == {"/kept/latched", "/kept/steady", "/kept/late"}
    assert qualities["/kept/late"].reliability.name == "BEST_EFFORT"
    assert qualities["/kept/latched"].durability.name == "TRANSIENT_LOCAL"


def _counts(message, topic):
    return any(value.key == topic and value.value == "20" for status in message.status for value in status.values)


def test_a_later_publisher_that_offers_less_is_heard_as_well(record, probe, tmp_path):
    process = record()
    publish(probe, probe.publisher(String, "kept/mixed", RELIABLE), 5)
    publish(probe, probe.publisher(String, "kept/mixed", LOSSY), 5, begin=5)
    assert process.stop() == 0
    assert texts(tmp_path / "bag", "/kept/mixed") == numbers(10)


def test_a_killed_recorder_leaves_every_finished_chunk(record, start_node, probe, tmp_path):
    process = record("chunk_s:=0.1")
    publish(probe, probe.publisher(String, "kept/a", RELIABLE), 40)
    probe.spin(0.5)
    process.send(signal.SIGKILL)
    assert process.wait() == -signal.SIGKILL
    play = ("tracked_bringup", "replay", "--ros-args", "-p", f"bag:={tmp_path / 'bag'}")
    refused = start_node(*play)
    played = start_node(*play, "-p", "recover:=true", "-p", "wait_for_readers:=[kept/a]", "-r", "__ns:=/again")
    heard = probe.collect(String, "/again/kept/a", RELIABLE)
    assert played.wait(START_LIMIT_S) == 0 and refused.wait(START_LIMIT_S) == 1
    (sentence,) = refused.output.strip().splitlines()
    assert "bag.mcap was cut off; `-p recover:=true` plays what is whole of it" in sentence
    probe.wait_until(lambda: len(heard) == 40, what="what was recorded")
    assert [message.data for message in heard] == numbers(40)
    assert texts(tmp_path / "bag" / "bag.mended.mcap", "/kept/a") == numbers(40)


def test_a_full_disk_ends_it_with_one_sentence_and_keeps_what_was_written(record, probe, tmp_path):
    process = record("chunk_s:=0.05")
    publisher = probe.publisher(String, "kept/big", RELIABLE)
    resource.prlimit(process.pid, resource.RLIMIT_FSIZE, (300_000, 300_000))
    for _ in range(200):
        if not process.is_running:
            break
        publisher.publish(String(data="x" * 5000))
        probe.spin(0.01)
    assert process.wait() == 1
    fatal = [line for line in process.output.splitlines() if "FATAL" in line]
    assert len(fatal) == 1 and "bag.mcap cannot be written (File too large)" in fatal[0]
    assert "Traceback" not in process.output
    assert len(texts(tmp_path / "bag", "/kept/big", recover=True)) > 10


def test_what_it_cannot_begin_with_is_named_and_nothing_is_a_recording_of_nothing(record, probe, tmp_path):
    idle = record()
    begun = {
        "bag exists already": record(wait=False),
        "'[' is neither a topic nor a regular expression": record("topics:=['[']", wait=False),
    }
    for said, process in begun.items():
        assert process.wait(START_LIMIT_S) in (1, 2)
        (line,) = process.output.strip().splitlines()
        assert "cannot start: " in line and said in line
    assert idle.stop(signal.SIGTERM) == 0
    assert "no message came on /kept/.*: there is no recording" in idle.output
    assert not (tmp_path / "bag").exists()
