"""The executor that serves a process."""

import os
from typing import Any

from rclpy.executors import SingleThreadedExecutor


def executor_kind() -> str:
    """What NODE_KIT_EXECUTOR asks for.

    Raises
    ------
    ValueError: it is neither ``events`` nor ``single``.
    """
    kind = os.environ.get("NODE_KIT_EXECUTOR", "events")
    if kind not in ("events", "single"):
        raise ValueError(f"NODE_KIT_EXECUTOR must be events or single, got {kind!r}")
    return kind


def make_executor(kind: str) -> Any:
    """The executor of a kind; where rclpy has no events executor, the single-threaded one."""
    if kind == "events":
        try:
            from rclpy.experimental import EventsExecutor
        except ImportError:
            return SingleThreadedExecutor()
        return EventsExecutor()
    return SingleThreadedExecutor()
