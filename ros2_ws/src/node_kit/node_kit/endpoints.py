"""Publishers and subscriptions of values instead of messages."""

import inspect
import time
from collections.abc import Callable
from typing import Any, Generic, TypeVar

from rclpy.node import Node
from rclpy.qos import QoSProfile

from node_kit.failures import CallbackFailures, callback_name, is_milestone
from node_kit.input_monitor import InputMonitor
from node_kit.rejection import RejectedMessage

Value = TypeVar("Value")
_SENDER_MEMORY_S = 2.0
_MOST_SENDERS_NAMED = 4
_UNNAMED = "_NODE_NAME_UNKNOWN_"  # what rmw calls a node whose endpoint is discovered before its name


class TypedPublisher:
    """Publishes what ``convert`` makes of a value; one message object is reused where ``convert`` takes ``into``."""

    def __init__(
        self, node: Node, message_type: type, topic: str, convert: Callable[..., Any], qos: QoSProfile
    ) -> None:
        self.publisher = node.create_publisher(message_type, topic, qos)
        self._convert = convert
        self._reused: dict[str, Any] = {}
        if "into" in inspect.signature(convert).parameters:
            self._reused["into"] = message_type()

    def publish(self, *values: Any) -> None:
        """Convert and publish; arguments are those of the conversion."""
        self.publisher.publish(self._convert(*values, **self._reused))


class TypedSubscription(Generic[Value]):
    """Calls ``callback`` with what ``convert`` makes of each message; counts what cannot be converted.

    expected_frame: if given, messages with another header.frame_id are rejected.
    A callback may itself raise `RejectedMessage`; it counts like one of the conversion.
    """

    def __init__(
        self,
        node: Node,
        message_type: type,
        topic: str,
        convert: Callable[[Any], Value],
        callback: Callable[[Value], None],
        qos: QoSProfile,
        *,
        monitor: InputMonitor,
        failures: CallbackFailures,
        on_rejection: Callable[[], None],
        expected_frame: str | None = None,
    ) -> None:
        self.ledger = monitor.add(topic)
        self._node = node
        self._convert = convert
        self._callback = callback
        self._monitor = monitor
        self._failures = failures
        self._on_rejection = on_rejection
        self._expected_frame = expected_frame
        self._senders = ""
        self._senders_known_s = float("-inf")
        self.subscription = node.create_subscription(message_type, topic, self._receive, qos)

    def _receive(self, message: Any) -> None:
        step: Callable[..., Any] = self._convert
        try:
            if self._expected_frame is not None and message.header.frame_id != self._expected_frame:
                raise RejectedMessage(f"frame is not {self._expected_frame}")
            value = self._convert(message)
            self.ledger.accepted += 1
            step = self._callback
            step(value)
        except RejectedMessage as rejection:
            if step is self._callback:
                self.ledger.accepted -= 1
            self._reject(rejection.reason)
        except Exception as error:
            self._failures.note(callback_name(step), error)

    def _reject(self, reason: str) -> None:
        now_s = time.monotonic()
        sender = self._sender(now_s)
        count = self.ledger.reject(reason, sender)
        if is_milestone(count):
            times = "" if count == 1 else f" (time {count})"
            self._node.get_logger().warning(f"rejected {self.ledger.topic} from {sender}: {reason}{times}")
        if self._monitor.note_rejection(self.ledger.topic, now_s):
            self._on_rejection()

    def _sender(self, now_s: float) -> str:
        """Names of the topic's publishers; rclpy does not say which of them sent a message."""
        if now_s - self._senders_known_s > _SENDER_MEMORY_S:
            infos = self._node.get_publishers_info_by_topic(self.subscription.topic_name)
            named = [info for info in infos if info.node_name != _UNNAMED]
            names = sorted({f"{info.node_namespace.rstrip('/')}/{info.node_name}" for info in named})
            if len(named) < len(infos):
                return "a publisher whose name is not known yet"
            if len(names) > _MOST_SENDERS_NAMED:
                names = [*names[:_MOST_SENDERS_NAMED], f"{len(names) - _MOST_SENDERS_NAMED} others"]
            self._senders = " or ".join(names) or "a publisher that has left"
            self._senders_known_s = now_s
        return self._senders
