import io
import sqlite3
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from rclpy.serialization import serialize_message
from rosbags.highlevel import AnyReader
from rosbags.interfaces import Qos, QosDurability, QosHistory, QosLiveliness, QosReliability, QosTime
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore
from tracked_interfaces.msg import SlipEstimate

from tracked_bringup.bags import BagError, BagReader, BagWriter, is_cut, mend, message_definition

HELLO, LATCHED = "/hello", "/latched"
FOREVER = QosTime(9223372036, 854775807)
SECOND = 10**9
MESSAGES = st.lists(st.tuples(st.integers(0, 2 * SECOND), st.binary(max_size=40)), min_size=1, max_size=40)
AT_ONCE = settings(max_examples=25, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])


def quality(durability: QosDurability) -> Qos:
    return Qos(
        QosHistory.KEEP_LAST,
        1,
        QosReliability.RELIABLE,
        durability,
        FOREVER,
        FOREVER,
        QosLiveliness.AUTOMATIC,
        FOREVER,
        False,
    )


def new_writer(folder: Path, **options: object) -> BagWriter:
    writer = BagWriter(folder, **options)  # type: ignore[arg-type]
    text = "std_msgs/msg/String"
    writer.add_topic(HELLO, text, message_definition(text), "RIHS01_aa", [quality(QosDurability.VOLATILE)])
    writer.add_topic(LATCHED, text, message_definition(text), "", [quality(QosDurability.TRANSIENT_LOCAL)] * 2)
    return writer


def contents(path: Path, **options: bool) -> list[bytes]:
    with BagReader(path, **options) as bag:
        return [message.data for message in bag.messages([HELLO])]


@AT_ONCE
@given(messages=MESSAGES, compress=st.booleans())
def test_messages_come_back_byte_for_byte_and_in_their_order(tmp_path_factory, messages, compress):
    folder = tmp_path_factory.mktemp("bag") / "bag"
    writer = new_writer(folder, chunk_s=0.1, compress=compress)
    stamp_ns = SECOND
    for step_ns, data in messages:
        stamp_ns += step_ns
        writer.write(HELLO, stamp_ns, data)
    writer.close()
    with BagReader(folder) as bag:
        read = list(bag.messages([HELLO]))
        assert bag.topics[HELLO].count == len(messages)
        assert (bag.start_ns, bag.end_ns) == (read[0].stamp_ns, stamp_ns + 1)
    assert [message.data for message in read] == [data for _, data in messages]
    assert read[-1].stamp_ns == stamp_ns


@AT_ONCE
@given(where=st.floats(0.0, 1.0), compress=st.booleans())
def test_of_a_file_cut_anywhere_every_whole_chunk_is_saved(tmp_path_factory, where, compress):
    folder = tmp_path_factory.mktemp("cut") / "bag"
    writer = new_writer(folder, chunk_s=0.1, compress=compress)
    ends = [writer.bytes_written]
    for index in range(30):
        writer.write(HELLO, SECOND + index * SECOND // 30, bytes([index]) * 20)
        if writer.bytes_written > ends[-1]:
            ends.append(writer.bytes_written)
    writer.close()
    whole = writer.file.read_bytes()
    cut = folder / "cut.mcap"
    cut.write_bytes(whole[: round(where * (len(whole) - 1))])
    expected = [bytes([index]) * 20 for index in range(30)]
    finished = sum(end <= cut.stat().st_size for end in ends[1:])
    if finished == 0:
        with pytest.raises(BagError):
            contents(cut, recover=True)
        return
    saved = contents(cut, recover=True)
    assert saved == expected[: len(saved)]
    assert len(saved) >= finished, "a chunk holds a message at least"
    assert not is_cut(cut.with_name("cut.mended.mcap"))


def test_an_unfinished_recording_is_read_up_to_its_last_chunk_and_only_where_that_is_wanted(tmp_path):
    writer, said = new_writer(tmp_path / "bag", chunk_s=0.5), []
    for index in range(10):
        writer.write(HELLO, index * SECOND // 10, bytes([index]))
    with pytest.raises(BagError, match=r"bag\.mcap was cut off; `-p recover:=true` plays"):
        BagReader(tmp_path / "bag")
    with BagReader(tmp_path / "bag", recover=True, say=said.append) as bag:
        assert [message.data for message in bag.messages([HELLO])] == [bytes([index]) for index in range(6)]
    assert said and "bag.mended.mcap" in said[0]
    before = (tmp_path / "bag" / "bag.mcap").read_bytes()
    assert writer.file.read_bytes() == before, "the recording itself is left as it was"


def test_a_chunk_does_not_wait_for_the_next_message(tmp_path):
    writer = new_writer(tmp_path / "bag", chunk_s=0.5)
    writer.write(HELLO, 0, b"only")
    writer.finish_old_chunk(SECOND // 10)
    with pytest.raises(BagError, match="no whole chunk"):
        mend(writer.file, tmp_path / "early.mcap")
    writer.finish_old_chunk(SECOND)
    assert contents(writer.file, recover=True) == [b"only"]


def test_memory_holds_one_chunk(tmp_path):
    writer = new_writer(tmp_path / "bag", chunk_s=60.0)
    for index in range(40):
        writer.write(HELLO, index, bytes(200_000))
        assert writer._storage.chunk.bio.tell() < 1.3 * 2**20
    assert writer.bytes_written > 6 * 2**20


def test_a_stamp_that_goes_back_does_not_make_the_file_unreadable(tmp_path):
    writer = new_writer(tmp_path / "bag", chunk_s=0.01)
    for stamp_ns in (5 * SECOND, SECOND, 6 * SECOND):
        writer.write(HELLO, stamp_ns, b"x")
    assert len(contents(writer.file, recover=True)) == 3


def test_qualities_hashes_and_definitions_are_kept_for_other_tools(tmp_path):
    writer = BagWriter(tmp_path / "bag")
    kind = "tracked_interfaces/msg/SlipEstimate"
    writer.add_topic("/slip", kind, message_definition(kind), "", [quality(QosDurability.TRANSIENT_LOCAL)])
    writer.write("/slip", SECOND, serialize_message(SlipEstimate()))
    writer.close()
    with BagReader(tmp_path / "bag") as bag:
        topic = bag.topics["/slip"]
        assert topic.latched and topic.type_hash.startswith("RIHS01_") and topic.writers == 1
    with AnyReader([tmp_path / "bag"]) as other:
        (connection,) = other.connections
        (_, _, data), *_ = other.messages()
        assert other.deserialize(data, kind).header.frame_id == ""
        assert "MSG: std_msgs/Header" in connection.msgdef.data


def test_a_definition_that_nobody_understands_is_no_obstacle(tmp_path):
    writer = BagWriter(tmp_path / "bag")
    writer.add_topic(HELLO, "odd_msgs/msg/Odd", "this is {no} definition", "", [])
    writer.write(HELLO, 0, b"x")
    writer.close()
    assert contents(tmp_path / "bag") == [b"x"]


def test_definition_of_a_type_holds_every_type_in_it_once():
    text = message_definition("nav_msgs/msg/Odometry")
    inside = [line.removeprefix("MSG: ") for line in text.splitlines() if line.startswith("MSG: ")]
    assert len(inside) == len(set(inside))
    assert {"std_msgs/Header", "builtin_interfaces/Time", "geometry_msgs/Quaternion"} <= set(inside)
    assert message_definition("no_such_package/msg/Nothing") == message_definition("std_srvs/srv/Trigger") == ""


def test_a_recording_without_messages_leaves_nothing_behind(tmp_path):
    new_writer(tmp_path / "bag").close()
    assert not (tmp_path / "bag").exists()


def test_places_that_cannot_be_written_are_named(tmp_path):
    (tmp_path / "file").write_text("")
    (tmp_path / "bag").mkdir()
    with pytest.raises(BagError, match="bag exists already: name another folder"):
        BagWriter(tmp_path / "bag")
    with pytest.raises(BagError, match=r"inside cannot be made \(Not a directory\)"):
        BagWriter(tmp_path / "file" / "inside")


class _Full(io.FileIO):
    """A file on a disk that has just become full."""

    def write(self, _data: object) -> int:
        raise OSError(28, "No space left on device")


def test_a_full_disk_is_named_and_what_was_written_stays(tmp_path):
    writer = new_writer(tmp_path / "bag", chunk_s=0.1)
    for index in range(3):
        writer.write(HELLO, index * SECOND, bytes([index]))
    writer._storage.bio = io.BufferedWriter(_Full(writer.file, "ab"))
    with pytest.raises(BagError, match=r"bag\.mcap cannot be written \(No space left on device\)"):
        writer.write(HELLO, 3 * SECOND, bytes(2**21))
    writer.close()
    assert contents(tmp_path / "bag", recover=True)[:2] == [b"\0", b"\1"]


def test_a_bag_of_rosbag2_in_sqlite3_is_read(tmp_path):
    store = get_typestore(Stores.ROS2_JAZZY)
    with Writer(tmp_path / "bag", version=9, storage_plugin=StoragePlugin.SQLITE3) as writer:
        connection = writer.add_connection(HELLO, "std_msgs/msg/String", typestore=store)
        for index in range(5):
            writer.write(connection, index * SECOND, bytes([index]))
    assert (
        contents(tmp_path / "bag") == contents(tmp_path / "bag" / "bag.db3") == [bytes([index]) for index in range(5)]
    )
    with BagReader(tmp_path / "bag") as bag:
        assert [message.data for message in bag.messages([HELLO], SECOND, 3 * SECOND)] == [b"\1", b"\2"]
        assert list(bag.messages(["/other"])) == []


def test_foreign_and_damaged_files_are_one_sentence(tmp_path):
    (tmp_path / "text.mcap").write_text("no recording at all")
    (tmp_path / "empty.mcap").write_text("")
    (tmp_path / "text.db3").write_text("no database at all")
    (tmp_path / "song.mp3").write_text("")
    (tmp_path / "folder").mkdir()
    sqlite3.connect(tmp_path / "other.db3").execute("create table songs (name text)").connection.close()
    (tmp_path / "meta").mkdir()
    (tmp_path / "meta" / "metadata.yaml").write_text("rosbag2_bagfile_information: [1, 2")
    for name in ("none", "text.mcap", "empty.mcap", "text.db3", "song.mp3", "folder", "other.db3", "meta"):
        with pytest.raises(BagError) as refusal:
            contents(tmp_path / name, recover=True)
        assert str(refusal.value).startswith(str(tmp_path / name)) and "\n" not in str(refusal.value)


def test_damage_in_the_middle_is_told_when_it_is_met(tmp_path):
    writer = new_writer(tmp_path / "bag", chunk_s=0.1, compress=True)
    for index in range(4):
        writer.write(HELLO, index * SECOND, bytes([index]) * 100)
    writer.close()
    data = bytearray(writer.file.read_bytes())
    place = data.rindex(b"\x28\xb5\x2f\xfd")  # where the last compressed chunk begins
    data[place + 4 : place + 12] = b"\xff" * 8
    writer.file.write_bytes(data)
    with pytest.raises(BagError, match=f"^{tmp_path / 'bag'} cannot be read: "):
        contents(tmp_path / "bag")


def test_a_topic_recorded_with_two_types_is_refused(tmp_path):
    writer = BagWriter(tmp_path / "bag")
    for kind in ("std_msgs/msg/String", "std_msgs/msg/Bool"):
        writer.add_topic(HELLO, kind, message_definition(kind), "", [])
    writer.write(HELLO, 0, b"x")
    writer.close()
    with pytest.raises(BagError, match="/hello was recorded as std_msgs/msg/String and as std_msgs/msg/Bool"):
        BagReader(tmp_path / "bag")
