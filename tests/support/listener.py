"""Hears many topics at full rate for next to nothing: messages are taken when asked, nothing spins."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import rclpy
from rclpy.context import Context
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rclpy.topic_endpoint_info import TopicEndpointInfo

DEPTH = 5000
"""Messages that a topic keeps between two looks: 40 s of the fastest."""


class Listener:
    """Keeps every message of the topics it hears, each with the wall time (s) at which it was published."""

    def __init__(self, node: Node) -> None:
        self.node = node
        self.messages: dict[str, list[Any]] = {}
        self.published_s: dict[str, list[float]] = {}
        self._subscriptions: dict[str, Any] = {}

    def hear(self, message_type: type, topic: str, *, latched: bool = False) -> list[Any]:
        """The list of the topic's messages, which `refresh` extends."""
        durability = DurabilityPolicy.TRANSIENT_LOCAL if latched else DurabilityPolicy.VOLATILE
        qos = QoSProfile(depth=DEPTH, reliability=ReliabilityPolicy.RELIABLE, durability=durability)
        self._subscriptions[topic] = self.node.create_subscription(message_type, topic, _never_called, qos)
        self.messages[topic], self.published_s[topic] = [], []
        return self.messages[topic]

    def refresh(self) -> None:
        """Take what has come."""
        for topic, subscription in self._subscriptions.items():
            with subscription.handle:
                while (taken := subscription.handle.take_message(subscription.msg_type, False)) is not None:
                    message, information = taken
                    self.messages[topic].append(message)
                    self.published_s[topic].append(information["source_timestamp"] * 1e-9)

    def publishers(self, topic: str) -> list[TopicEndpointInfo]:
        """Who publishes a topic."""
        return self.node.get_publishers_info_by_topic(self.node.resolve_topic_name(topic))

    def subscribers(self, topic: str) -> list[TopicEndpointInfo]:
        """Who subscribes a topic, this listener left out."""
        endpoints = self.node.get_subscriptions_info_by_topic(self.node.resolve_topic_name(topic))
        return [endpoint for endpoint in endpoints if endpoint.node_name != self.node.get_name()]


@contextmanager
def own_listener(domain: int, namespace: str = "") -> Iterator[Listener]:
    """A listener in the given domain, gone with the block."""
    context = Context()
    rclpy.init(context=context, domain_id=domain)
    node = Node("test_listener", context=context, namespace=namespace or None, start_parameter_services=False)
    try:
        yield Listener(node)
    finally:
        node.destroy_node()
        context.try_shutdown()


def _never_called(_message: Any) -> None:
    """Messages are taken by `Listener.refresh`; there is no executor."""
