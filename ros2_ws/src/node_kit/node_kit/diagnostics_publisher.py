"""Publishes a node's diagnostics with the conventions of diagnostic_updater."""

import time
from collections.abc import Callable, Mapping
from typing import Any

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from rclpy.clock import Clock, ClockType
from rclpy.node import Node

from node_kit.diagnostics import DiagnosticBook, Level, TaskReport
from node_kit.qos import STATE

PERIOD_S = 1.0


class DiagnosticsPublisher:
    """All tasks of a node on the topic diagnostics, once per second of wall time and on change.

    hardware_id: what the statuses speak of; the node's namespace by default.
    """

    def __init__(self, node: Node) -> None:
        self.hardware_id = node.get_namespace().strip("/") or "none"
        self._node = node
        self._book = DiagnosticBook()
        self._sources: list[Callable[[], Any]] = []
        self._publisher = node.create_publisher(DiagnosticArray, "diagnostics", STATE)
        self._timer = node.create_timer(PERIOD_S, self._publish_all, clock=Clock(clock_type=ClockType.STEADY_TIME))

    def report(self, name: str, level: Level, message: str, values: Mapping[str, object] | None = None) -> None:
        """Note how the task ``name`` does; a change of level or message is published at once."""
        urgent = self._book.report(name, level, message, values or {}, time.monotonic())
        if urgent is not None:
            self._publish([urgent])

    def add_source(self, source: Callable[[], Any]) -> None:
        """Call ``source`` before each periodic publication, so that it can report."""
        self._sources.append(source)

    def _publish_all(self) -> None:
        for source in self._sources:
            source()
        reports = self._book.all()
        if reports:
            self._publish(reports)

    def _publish(self, reports: list[TaskReport]) -> None:
        message = DiagnosticArray()
        message.header.stamp = self._node.get_clock().now().to_msg()
        message.status = [self._status(report) for report in reports]
        self._publisher.publish(message)

    def _status(self, report: TaskReport) -> DiagnosticStatus:
        return DiagnosticStatus(
            level=bytes([report.level]),
            name=f"{self._node.get_name()}: {report.name}",
            message=report.message,
            hardware_id=self.hardware_id,
            values=[KeyValue(key=key, value=value) for key, value in report.values.items()],
        )
