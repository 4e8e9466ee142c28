"""Node replay: plays a recording, or any ROS 2 bag (MCAP, sqlite3), into the graph on its own stamps."""

import sys
import time
from pathlib import Path
from typing import Any

from rclpy.duration import Duration
from rosgraph_msgs.msg import Clock

from node_kit import BadParameterError, Level, Parameter, ParameterTable, StackNode, qos, run
from node_kit.conversions import clock_to_message
from tracked_bringup.bags import BagError, BagReader, BagTopic, Playback, RawMessage, TopicChoice
from tracked_bringup.nodes.raw_topics import UnknownTypeError, hash_of, message_class, playing_profile
from tracked_types import to_nanoseconds

_CLOCK = "/clock"
PARAMETERS = ParameterTable(
    Parameter("bag", "", "The recording: a folder, an .mcap or a .db3 file."),
    Parameter("topics", (".*",), "Topics to play, as they were recorded: names or regular expressions."),
    Parameter("exclude", ("",), "Topics to leave out, written like those to play."),
    Parameter("rate", 1.0, "How many times faster than it was recorded.", low=0.01, high=100.0),
    Parameter("start_s", 0.0, "Leave out what was recorded before this time.", unit="s", low=0.0, high=1e7),
    Parameter("end_s", 0.0, "Leave out what was recorded from this time on; 0: nothing.", unit="s", low=0.0, high=1e7),
    Parameter("loop", False, "Begin anew at the end."),
    Parameter("clock", True, "Publish clock: the recorded one where there is one, else the time of recording."),
    Parameter("wait_for_readers", ("",), "Topics, as they were recorded, that must be subscribed before the start."),
    Parameter("wait_s", 30.0, "How long to wait for readers; then the node fails.", unit="s", low=0.0, high=3600.0),
    Parameter("recover", False, "Play what is whole of a recording that was cut off, from a mended copy beside it."),
)
_CLOCK_PERIOD_S = 1.0 / 60.0
_BATCH = 100
_LATCHED_DEPTH = 100
_ACKNOWLEDGE_LIMIT_S = 2.0
_LOOK_PERIOD_S = 0.05


class ReplayNode(StackNode):
    """Publishes recorded messages as they are, below its own namespace and with its remappings."""

    NAME = "replay"
    PARAMETERS = PARAMETERS

    def __init__(self) -> None:
        super().__init__()
        if not self.value("bag"):
            raise BadParameterError("parameter bag must name a recording")
        self.bag = BagReader(Path(self.value("bag")), recover=self.value("recover"), say=self.get_logger().warning)
        self.raw_publishers = {name: self.publisher_of(topic) for name, topic in self.chosen().items()}
        self.awaited = self.readers_to_await()
        self.own_clock = None
        if self.value("clock") and _CLOCK not in self.raw_publishers:
            self.own_clock = self.publish_typed(Clock, "clock", clock_to_message, qos.STATE)
        self.playback = self.from_the_start()
        if self.playback.finished:
            raise BagError(f"{self.bag.path}: nothing was recorded on these topics in that time")
        self.played = 0
        self.started_s = time.monotonic()
        self.clock_due_s = 0.0
        self.diagnostics.add_source(self.report)

    def chosen(self) -> dict[str, BagTopic]:
        """Topics to play."""
        choice = TopicChoice(self.value("topics"), self.value("exclude"))
        chosen = {name: topic for name, topic in self.bag.topics.items() if name in choice}
        if not self.value("clock"):
            chosen.pop(_CLOCK, None)
        if not chosen:
            there = ", ".join(sorted(self.bag.topics)) or "none"
            raise BagError(f"{self.bag.path}: no topic is {choice}; there are {there}")
        return chosen

    def publisher_of(self, topic: BagTopic) -> Any:
        """A publisher of a recorded topic, sure that its type is still the recorded one."""
        try:
            kind = message_class(topic.type_name)
        except UnknownTypeError as error:
            raise BagError(f"{self.bag.path}: {topic.name} cannot be played, {error}") from error
        depth = min(max(topic.writers, 1), _LATCHED_DEPTH) if topic.latched else qos.STATE.depth
        profile = playing_profile(latched=topic.latched, depth=depth)
        publisher = self.create_publisher(kind, topic.name.removeprefix("/"), profile)
        own = [
            endpoint
            for endpoint in self.get_publishers_info_by_topic(publisher.topic_name)
            if endpoint.node_name == self.get_name() and endpoint.node_namespace == self.get_namespace()
        ]
        spoken = hash_of(own)
        if topic.type_hash and spoken and spoken != topic.type_hash:
            raise BagError(f"{self.bag.path}: {topic.name} cannot be played, its {topic.type_name} is another one here")
        return publisher

    def readers_to_await(self) -> list[Any]:
        """Publishers that must be heard before the start."""
        names = [f"/{name.removeprefix('/')}" for name in self.value("wait_for_readers") if name]
        unknown = [name for name in names if name not in self.raw_publishers]
        if unknown:
            raise BadParameterError(f"parameter wait_for_readers names {unknown[0]}, which is not played")
        return [self.raw_publishers[name] for name in names]

    def from_the_start(self) -> Playback:
        """The wanted part of the recording, not begun."""
        start_ns = self.bag.start_ns + to_nanoseconds(self.value("start_s"))
        end_ns = self.bag.start_ns + to_nanoseconds(self.value("end_s")) if self.value("end_s") else None
        return Playback(self.bag.messages(self.raw_publishers.keys(), start_ns, end_ns), self.value("rate"))

    def idle_work(self) -> float:
        """Publish what is due; the time until the next is."""
        if self.exit_code is not None:
            return _LOOK_PERIOD_S
        try:
            return self.wait_for_readers() if self.awaited else self.play()
        except BagError as error:
            self.request_exit(1, str(error))
            return 0.0

    def wait_for_readers(self) -> float:
        """Look who is still missing."""
        self.awaited = [publisher for publisher in self.awaited if not publisher.get_subscription_count()]
        if not self.awaited:
            return 0.0
        if time.monotonic() - self.started_s > self.value("wait_s"):
            missing = ", ".join(publisher.topic_name for publisher in self.awaited)
            raise BagError(f"nobody reads {missing} after {self.value('wait_s'):g} s")
        return _LOOK_PERIOD_S

    def play(self) -> float:
        """Publish what is due, at most so much that callbacks are not kept waiting."""
        for _ in range(_BATCH):
            message = self.playback.due(time.monotonic())
            if message is None:
                break
            self.publish(message)
        now_s = time.monotonic()
        if self.own_clock is not None and now_s >= self.clock_due_s:
            self.clock_due_s = now_s + _CLOCK_PERIOD_S
            self.own_clock.publish(self.playback.time_ns(now_s) or self.bag.start_ns)
        if not self.playback.finished:
            return max(0.0, min(self.playback.wait_s(now_s), _CLOCK_PERIOD_S))
        if self.value("loop"):
            self.playback = self.from_the_start()
        else:
            self.request_exit(0, f"{self.bag.path}: {self.played} messages played")
        return 0.0

    def publish(self, message: RawMessage) -> None:
        """Send a message as it was recorded."""
        self.raw_publishers[message.topic].publish(message.data)
        self.played += 1

    def report(self) -> None:
        """How far it is."""
        values = {"messages": self.played}
        if self.awaited:
            missing = ", ".join(publisher.topic_name for publisher in self.awaited)
            self.diagnostics.report("replay", Level.WARN, f"waiting for readers of {missing}", values)
        else:
            self.diagnostics.report("replay", Level.OK, f"playing {self.bag.path}", values)

    def safe_stop(self) -> None:
        """Let the last messages arrive."""
        deadline_s = time.monotonic() + _ACKNOWLEDGE_LIMIT_S
        for publisher in self.raw_publishers.values():
            publisher.wait_for_all_acked(Duration(seconds=max(0.0, deadline_s - time.monotonic())))
        self.bag.close()


def main() -> int:
    """Run the node; the exit code of the process."""
    return run(ReplayNode)


if __name__ == "__main__":
    sys.exit(main())
