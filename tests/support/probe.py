"""A node of the test's own, and waiting that spins instead of sleeping."""

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import rclpy
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import QoSProfile

MATCHING_LIMIT_S = 10.0


class Probe:
    """Subscribes, publishes and calls services in a context of its own."""

    def __init__(self, node: Node, executor: SingleThreadedExecutor) -> None:
        self.node = node
        self._executor = executor

    def wait_until(self, condition: Callable[[], Any], *, timeout_s: float = MATCHING_LIMIT_S, what: str = "") -> Any:
        """Spin until the condition holds and return what it returned.

        Raises:
            AssertionError: it did not hold in time; names ``what`` was awaited and the graph as seen.
        """
        deadline = time.monotonic() + timeout_s
        while True:
            result = condition()
            if result:
                return result
            left = deadline - time.monotonic()
            if left <= 0.0:
                seen = sorted(self.node.get_node_names())
                raise AssertionError(f"waited {timeout_s} s in vain for {what or condition}; nodes seen: {seen}")
            self._executor.spin_once(timeout_sec=min(left, 0.05))

    def spin(self, seconds: float) -> None:
        """Serve what comes for so long."""
        deadline = time.monotonic() + seconds
        while (left := deadline - time.monotonic()) > 0.0:
            self._executor.spin_once(timeout_sec=left)

    def collect(self, message_type: type, topic: str, qos: QoSProfile | int = 10) -> list[Any]:
        """A list that grows by every message on the topic while the probe spins."""
        received: list[Any] = []
        self.node.create_subscription(message_type, topic, received.append, qos)
        return received

    def publisher(self, message_type: type, topic: str, qos: QoSProfile | int = 10, *, readers: int = 1) -> Any:
        """A publisher that has met its readers."""
        publisher = self.node.create_publisher(message_type, topic, qos)
        self.wait_until(lambda: publisher.get_subscription_count() >= readers, what=f"{readers} readers of {topic}")
        return publisher

    def call(self, service_type: Any, name: str, request: Any = None, *, timeout_s: float = MATCHING_LIMIT_S) -> Any:
        """The response of a service, awaited from its appearance on."""
        client = self.node.create_client(service_type, name)
        self.wait_until(client.service_is_ready, timeout_s=timeout_s, what=f"service {name}")
        future = client.call_async(request if request is not None else service_type.Request())
        self.wait_until(future.done, timeout_s=timeout_s, what=f"an answer of {name}")
        self.node.destroy_client(client)
        return future.result()


@contextmanager
def own_probe(domain: int, name: str = "test_probe") -> Iterator[Probe]:
    """A probe in the given domain, gone with the block."""
    context = Context()
    rclpy.init(context=context, domain_id=domain)
    executor = SingleThreadedExecutor(context=context)
    node = rclpy.create_node(name, context=context)
    executor.add_node(node)
    try:
        yield Probe(node, executor)
    finally:
        executor.remove_node(node)
        node.destroy_node()
        executor.shutdown()
        context.try_shutdown()
