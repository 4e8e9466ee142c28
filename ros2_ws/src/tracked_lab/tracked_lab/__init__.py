"""The stack in one process and in lock-step, without ROS: where evidence is made."""

from tracked_lab.lock_step import drive
from tracked_lab.stack import Reaction, Stack

__all__ = ["Reaction", "Stack", "drive"]
