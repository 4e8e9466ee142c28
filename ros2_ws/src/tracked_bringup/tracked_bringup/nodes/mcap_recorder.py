"""Node mcap_recorder: any topics, as raw messages, into a ROS 2 bag (MCAP) that survives the node's death."""

import math
import sys
import time
from dataclasses import dataclass
from datetime import datetime
from functools import partial
from pathlib import Path
from typing import Any

from node_kit import Level, Parameter, ParameterTable, StackNode, run
from tracked_bringup.bags import BagError, BagWriter, TopicChoice, message_definition
from tracked_bringup.nodes.raw_topics import UnknownTypeError, hash_of, hears, matching_profile, message_class, offered

PARAMETERS = ParameterTable(
    Parameter(
        "topics",
        (".*",),
        "Topics to record: names or regular expressions; below the namespace where they begin without a slash.",
    ),
    Parameter("exclude", ("",), "Topics to leave out, written like those to record."),
    Parameter("folder", "", "Folder that the recording becomes, not there yet; empty: recording_DATE_TIME."),
    Parameter(
        "chunk_s",
        1.0,
        "Messages are handed to the operating system at least so often; a killed recorder loses no more.",
        unit="s",
        low=0.05,
        high=60.0,
    ),
    Parameter("compress", False, "Compress the recording (zstd), which costs processor time."),
    Parameter("depth", 200, "Messages of one topic that may wait for this node.", low=1, high=10_000),
)
_LOOK_PERIOD_S = 0.1
_PATIENCE_S = 5.0
_DRAIN_LIMIT_S = 5.0


@dataclass(slots=True)
class _Heard:
    """A topic that is being recorded."""

    kind: Any
    subscription: Any


class McapRecorderNode(StackNode):
    """Subscribes whatever is wanted as soon as somebody publishes it; publishes nothing but diagnostics."""

    NAME = "mcap_recorder"
    PARAMETERS = PARAMETERS

    def __init__(self) -> None:
        super().__init__()
        self.choice = TopicChoice(self.value("topics"), self.value("exclude"), self.get_namespace())
        folder = self.value("folder") or f"recording_{datetime.now():%Y%m%d_%H%M%S}"
        self.bag = BagWriter(Path(folder), chunk_s=self.value("chunk_s"), compress=self.value("compress"))
        self.heard: dict[str, _Heard] = {}
        self.not_recorded: dict[str, str] = {}
        self.started_s = time.monotonic()
        self.said_nothing_there = False
        self.diagnostics.add_source(self.report)
        self.every_wall(_LOOK_PERIOD_S, self.look)
        self.look()

    def look(self) -> None:
        """Subscribe what is new, and finish a chunk that waits for no further message."""
        for topic, types in self.get_topic_names_and_types():
            if topic in self.choice:
                writers = self.get_publishers_info_by_topic(topic)
                if writers:
                    self.hear(topic, types, writers)
        if not (self.heard or self.not_recorded or self.said_nothing_there) and self.waited_s > _PATIENCE_S:
            self.said_nothing_there = True
            self.get_logger().warning(f"nobody publishes {self.choice} yet; waiting")
        self.guarded(self.bag.finish_old_chunk, time.time_ns())

    def hear(self, topic: str, types: list[str], writers: list[Any]) -> None:
        """Subscribe a topic, or subscribe it anew where a later publisher offers less than the others."""
        profile = matching_profile((writer.qos_profile for writer in writers), self.value("depth"))
        known = self.heard.get(topic)
        if known is not None and hears(known.subscription.qos_profile, profile):
            return
        if known is not None:
            self.take_waiting(topic, known, math.inf)
            self.destroy_subscription(known.subscription)
        kind = known.kind if known is not None else self.begin(topic, types, writers)
        if kind is not None:
            callback = partial(self.on_message, topic)
            self.heard[topic] = _Heard(kind, self.create_subscription(kind, topic, callback, profile, raw=True))

    def begin(self, topic: str, types: list[str], writers: list[Any]) -> Any:
        """State a new topic in the recording; the class of its messages, None if it cannot be recorded."""
        try:
            if len(types) > 1:
                raise UnknownTypeError(f"it has several types: {', '.join(types)}")
            kind = message_class(types[0])
        except UnknownTypeError as error:
            if topic not in self.not_recorded:
                self.get_logger().warning(f"{topic} is not recorded: {error}")
            self.not_recorded[topic] = str(error)
            return None
        self.not_recorded.pop(topic, None)
        self.bag.add_topic(topic, types[0], message_definition(types[0]), hash_of(writers), offered(writers))
        return kind

    def on_message(self, topic: str, data: bytes) -> None:
        """Keep a message as it came."""
        self.guarded(self.bag.write, topic, time.time_ns(), data)

    def guarded(self, step: Any, *arguments: Any) -> None:
        """Do a step of writing; where nothing more can be written, the node ends."""
        if self.exit_code is None:
            try:
                step(*arguments)
            except BagError as error:
                self.request_exit(1, str(error))

    @property
    def waited_s(self) -> float:
        """Time since the node's start."""
        return time.monotonic() - self.started_s

    def report(self) -> None:
        """How much there is of what."""
        values = {**self.bag.counts, "bytes": self.bag.bytes_written, **self.not_recorded}
        if self.not_recorded:
            topics = ", ".join(self.not_recorded)
            self.diagnostics.report("recording", Level.WARN, f"not recorded: {topics}", values)
        elif not self.heard:
            self.diagnostics.report("recording", Level.WARN, f"nobody publishes {self.choice}", values)
        else:
            self.diagnostics.report("recording", Level.OK, f"recording to {self.bag.folder}", values)

    def safe_stop(self) -> None:
        """Take in what has arrived and waits for its turn, then close the recording."""
        deadline_s = time.monotonic() + _DRAIN_LIMIT_S
        for topic, heard in self.heard.items():
            self.take_waiting(topic, heard, deadline_s)
        try:
            self.bag.close()
        except BagError as error:
            self.exit_code = 1
            self.get_logger().fatal(str(error))
        self.get_logger().info(self.summary())

    def take_waiting(self, topic: str, heard: _Heard, deadline_s: float) -> None:
        """Keep the messages of a topic that wait for their turn; up to ``depth`` may."""
        while self.exit_code in (None, 0) and time.monotonic() < deadline_s:
            with heard.subscription.handle:
                taken = heard.subscription.handle.take_message(heard.kind, True)
            if taken is None:
                break
            self.on_message(topic, taken[0])

    def summary(self) -> str:
        """What was recorded, topic by topic."""
        counts = self.bag.counts
        if not counts.total():
            return f"no message came on {self.choice}: there is no recording"
        lines = [f"{self.bag.file}: {counts.total()} messages of {len(counts)} topics"]
        return "\n".join([*lines, *(f"  {count:8} {topic}" for topic, count in sorted(counts.items()))])


def main() -> int:
    """Run the node; the exit code of the process."""
    return run(McapRecorderNode)


if __name__ == "__main__":
    sys.exit(main())
