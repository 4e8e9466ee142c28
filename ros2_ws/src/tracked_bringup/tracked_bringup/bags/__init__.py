"""Recordings of raw messages: written so that a killed recorder loses next to nothing, and read again. No rclpy."""

from tracked_bringup.bags.bag_error import BagError
from tracked_bringup.bags.bag_reader import BagReader, BagTopic, RawMessage
from tracked_bringup.bags.bag_writer import BagWriter
from tracked_bringup.bags.cut_file import is_cut, mend
from tracked_bringup.bags.message_definition import message_definition
from tracked_bringup.bags.playback import Playback
from tracked_bringup.bags.topic_choice import TopicChoice

__all__ = [
    "BagError",
    "BagReader",
    "BagTopic",
    "BagWriter",
    "Playback",
    "RawMessage",
    "TopicChoice",
    "is_cut",
    "mend",
    "message_definition",
]
