"""A recording being read: one of our own, or any ROS 2 bag as MCAP or sqlite3."""

from collections.abc import Callable, Collection, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import NamedTuple, Self

from rosbags.interfaces import Connection, ConnectionExtRosbag2, QosDurability
from rosbags.rosbag2 import Reader

from tracked_bringup.bags.bag_error import BagError, one_line
from tracked_bringup.bags.bag_writer import UNKNOWN_HASH
from tracked_bringup.bags.cut_file import is_cut, mend

_STORED = ("*.mcap", "*.db3")


class RawMessage(NamedTuple):
    """One serialized message and when it was recorded."""

    stamp_ns: int
    topic: str
    data: bytes


@dataclass(frozen=True, slots=True)
class BagTopic:
    """A recorded topic. type_hash: empty where the recording does not say. latched: offered as transient local.

    writers: how many publishers it had when its recording began.
    """

    name: str
    type_name: str
    count: int
    type_hash: str
    latched: bool
    writers: int


class BagReader:
    """Topics and messages of a recording: a folder, an .mcap or a .db3 file.

    recover: read what is whole of a file that was cut off; ``say`` is then told of the mended copy beside it.

    Raises
    ------
    BagError: there is none, it is foreign or damaged, or it was cut off and ``recover`` is not wanted.
    """

    def __init__(self, path: Path, *, recover: bool = False, say: Callable[[str], object] = lambda _text: None) -> None:
        self.path = _readable(path, recover, say)
        with _told(self.path):
            self._reader = Reader(self.path)
            self._reader.open()
            self.topics = _topics(self._reader.connections)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    @property
    def start_ns(self) -> int:
        """Stamp of the first message; 0 in a recording without messages."""
        return self._reader.start_time if self._reader.message_count else 0

    @property
    def end_ns(self) -> int:
        """Stamp just after the last message."""
        return self._reader.end_time

    def messages(
        self, topics: Collection[str], start_ns: int | None = None, end_ns: int | None = None
    ) -> Iterator[RawMessage]:
        """Messages of these topics, in the order of their stamps, from ``start_ns`` on and before ``end_ns``.

        Raises
        ------
        BagError: the recording is damaged there.
        """
        wanted = [connection for connection in self._reader.connections if connection.topic in topics]
        if not wanted:
            return
        with _told(self.path):
            for connection, stamp_ns, data in self._reader.messages(wanted, start_ns, end_ns):
                yield RawMessage(stamp_ns, connection.topic, bytes(data))

    def close(self) -> None:
        """Let go of the file."""
        self._reader.close()


def _readable(path: Path, recover: bool, say: Callable[[str], object]) -> Path:
    """What of a recording's path rosbags can open; mends a file where that is wanted."""
    if not path.exists():
        raise BagError(f"{path}: there is no such recording")
    cut = [file for file in _files(path) if file.suffix == ".mcap" and is_cut(file)]
    if not cut:
        return path if path.is_file() or (path / "metadata.yaml").exists() else _files(path)[0]
    if len(_files(path)) > 1:
        raise BagError(f"{cut[0]} was cut off, and is not the only file of {path}: name one file")
    if not recover:
        raise BagError(f"{cut[0]} was cut off; `-p recover:=true` plays what is whole of it")
    mended = cut[0].with_name(f"{cut[0].stem}.mended.mcap")
    chunks = mend(cut[0], mended)
    say(f"{cut[0]} was cut off: its {chunks} whole chunks are now {mended}")
    return mended


def _files(path: Path) -> list[Path]:
    if path.is_file():
        return [path]
    found = sorted(file for kind in _STORED for file in path.glob(kind) if not file.stem.endswith(".mended"))
    if not found and not (path / "metadata.yaml").exists():
        raise BagError(f"{path} is no recording: it has neither metadata.yaml nor a file {' or '.join(_STORED)}")
    return found


def _topics(connections: Iterable[Connection]) -> dict[str, BagTopic]:
    topics: dict[str, BagTopic] = {}
    for topic in map(_topic, connections):
        known = topics.get(topic.name, topic)
        if known.type_name != topic.type_name:
            raise BagError(f"{topic.name} was recorded as {known.type_name} and as {topic.type_name}")
        topics[topic.name] = topic if known is topic else replace(topic, count=known.count + topic.count)
    return topics


def _topic(connection: Connection) -> BagTopic:
    offered = connection.ext.offered_qos_profiles if isinstance(connection.ext, ConnectionExtRosbag2) else []
    return BagTopic(
        name=connection.topic,
        type_name=connection.msgtype,
        count=connection.msgcount,
        type_hash="" if connection.digest == UNKNOWN_HASH else connection.digest,
        latched=bool(offered) and all(qos.durability is QosDurability.TRANSIENT_LOCAL for qos in offered),
        writers=len(offered),
    )


@contextmanager
def _told(path: Path) -> Iterator[None]:
    """Whatever a damaged or foreign file provokes inside rosbags becomes one sentence."""
    try:
        yield
    except (BagError, GeneratorExit):
        raise
    except Exception as error:
        raise BagError(f"{path} cannot be read: {one_line(error)}") from error
