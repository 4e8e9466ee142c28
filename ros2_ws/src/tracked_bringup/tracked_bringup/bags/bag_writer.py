"""A recording being written: raw messages into an MCAP file, chunk by chunk."""

from collections import Counter
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import cast

from rosbags.interfaces import Connection, Qos
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer
from rosbags.rosbag2.storage_mcap import McapWriter
from rosbags.typesys import Stores, TypesysError, get_types_from_msg, get_typestore

from tracked_bringup.bags.bag_error import BagError, one_line
from tracked_types import to_nanoseconds

UNKNOWN_HASH = f"RIHS01_{'0' * 64}"


class BagWriter:
    """A ROS 2 bag of one MCAP file below ``folder``, which must not exist yet.

    A chunk of messages is handed to the operating system when it is full (1 MiB) or ``chunk_s`` old, and with it the
    types and topics that are new in it: whoever kills the process takes the messages of the unfinished chunk and no
    others. Only that chunk is held in memory.

    Raises
    ------
    BagError: the folder exists already or cannot be made; later: nothing more can be written.
    """

    def __init__(self, folder: Path, *, chunk_s: float = 1.0, compress: bool = False) -> None:
        self.folder = folder
        self.counts: Counter[str] = Counter()
        self._topics: dict[str, Connection] = {}
        self._chunk_ns = to_nanoseconds(chunk_s)
        self._chunk_began_ns: int | None = None
        self._chunks = 0
        self._newest_ns = 0
        self._broken = False
        if folder.exists():
            raise BagError(f"{folder} exists already: name another folder")
        self._writer = Writer(folder, version=9, storage_plugin=StoragePlugin.MCAP)
        if compress:
            self._writer.set_compression(CompressionMode.STORAGE, CompressionFormat.ZSTD)
        try:
            self._writer.open()
            self._storage.bio.flush()
        except Exception as error:
            raise BagError(f"{folder} cannot be made ({one_line(error)})") from error

    @property
    def file(self) -> Path:
        """The MCAP file."""
        return self.folder / f"{self.folder.name}.mcap"

    @property
    def bytes_written(self) -> int:
        """Size of the file, the unfinished chunk left out."""
        return self.file.stat().st_size if self.file.exists() else 0

    def add_topic(self, topic: str, type_name: str, definition: str, type_hash: str, offered: Sequence[Qos]) -> None:
        """State a topic before its first message; ``offered`` are the qualities of service of its publishers.

        Readers compare the type's hash with its definition: where the former is not known, it is made from the latter.
        """
        known_hash = type_hash or (_hash(type_name, definition) if definition else UNKNOWN_HASH)
        self._topics[topic] = self._writer.add_connection(
            topic, type_name, msgdef=definition, rihs01=known_hash, offered_qos_profiles=offered
        )

    def write(self, topic: str, stamp_ns: int, data: bytes) -> None:
        """Append one serialized message; a stamp before that of the last message is taken as that stamp.

        Raises
        ------
        BagError: it cannot be written.
        KeyError: the topic was not added.
        """
        # In the order of stamps a file can be read from beginning to end, also where its index is missing.
        self._newest_ns = max(self._newest_ns, stamp_ns)
        if self._chunk_began_ns is None:
            self._chunk_began_ns = self._newest_ns
        try:
            self._writer.write(self._topics[topic], self._newest_ns, data)
            self.counts[topic] += 1
            if len(self._storage.chunks) != self._chunks:
                self._hand_over()
        except OSError as error:
            raise self._unwritable(error) from error
        self.finish_old_chunk(self._newest_ns)

    def finish_old_chunk(self, now_ns: int) -> None:
        """Finish the chunk if it has become old; to be called also while no message comes.

        Raises
        ------
        BagError: it cannot be written.
        """
        if self._chunk_began_ns is None or now_ns - self._chunk_began_ns < self._chunk_ns:
            return
        try:
            self._storage.close_chunk()
            self._hand_over()
        except OSError as error:
            raise self._unwritable(error) from error

    def close(self) -> None:
        """Write index and metadata; a recording without messages leaves nothing behind.

        After a failure nothing is written any more: it would stand behind half a chunk.

        Raises
        ------
        BagError: they cannot be written; the finished chunks stay.
        """
        if self._broken:
            with suppress(OSError):
                self._writer.abort()
            return
        try:
            self._writer.close()
            if not self.counts.total():
                for file in (self.file, self.folder / "metadata.yaml"):
                    file.unlink()
                self.folder.rmdir()
        except OSError as error:
            failure = self._unwritable(error)
            self.close()
            raise failure from error

    @property
    def _storage(self) -> McapWriter:
        return cast(McapWriter, self._writer.storage)

    def _hand_over(self) -> None:
        self._storage.bio.flush()
        self._chunks = len(self._storage.chunks)
        self._chunk_began_ns = None

    def _unwritable(self, error: OSError) -> BagError:
        self._broken = True
        return BagError(f"{self.file} cannot be written ({one_line(error)}): the finished chunks in it stay")


def _hash(type_name: str, definition: str) -> str:
    store = get_typestore(Stores.EMPTY)
    try:
        store.register(get_types_from_msg(definition, type_name))
        return store.hash_rihs01(type_name)
    except (TypesysError, KeyError):
        return UNKNOWN_HASH
