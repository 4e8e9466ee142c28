"""Base class of every node of the stack."""

import re
import time
from collections.abc import Callable
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar

from rclpy.clock import Clock, ClockType
from rclpy.node import Node
from rclpy.qos import QoSProfile
from rclpy.service import Service
from rclpy.timer import Timer

from node_kit.common_parameters import COMMON_PARAMETERS
from node_kit.diagnostics import Level
from node_kit.diagnostics_publisher import DiagnosticsPublisher
from node_kit.endpoints import TypedPublisher, TypedSubscription, Value
from node_kit.failures import CallbackFailures
from node_kit.input_monitor import InputMonitor
from node_kit.node_parameters import NodeParameters, value_or_ros
from node_kit.parameter import BadParameterError
from node_kit.parameter_table import ParameterTable
from node_kit.services import answering
from tracked_types.setting import settings_of

if TYPE_CHECKING:
    from node_kit.transforms import TransformBroadcaster

FRESH_S = 5.0
_FRAME_PREFIX = re.compile(r"([A-Za-z_][A-Za-z0-9_]*/)*([A-Za-z_][A-Za-z0-9_]*)?")


class StackNode(Node):
    """A node whose parameters come from a table and whose inputs are checked before it sees them.

    A subclass sets NAME and PARAMETERS, makes its algorithm and endpoints in ``__init__`` and translates in its
    callbacks::

        class EchoNode(StackNode):
            NAME = "echo"
            PARAMETERS = ParameterTable.from_settings(EchoSettings)

            def __init__(self) -> None:
                super().__init__()
                self.echo = Echo(EchoSettings(**self.tuning(EchoSettings)))
                self.commands = self.publish_typed(TwistStamped, "cmd_vel", command_to_message, qos.COMMAND)
                self.subscribe_typed(Odometry, "odom", odometry_from_message, self.on_odometry, qos.STATE)

            def on_odometry(self, odometry) -> None:
                self.commands.publish(self.echo.update(odometry))

        def main() -> int:
            return run(EchoNode)

    An exception in a callback is logged with the callback's name, counted on diagnostics and served on.

    Raises
    ------
    BadParameterError: a parameter given by the user cannot be used.
    """

    NAME: ClassVar[str]
    PARAMETERS: ClassVar[ParameterTable] = ParameterTable()

    def __init__(self, **node_options: Any) -> None:
        super().__init__(self.NAME, automatically_declare_parameters_from_overrides=True, **node_options)
        self.exit_code: int | None = None
        self.typed_publishers: list[TypedPublisher] = []
        self.typed_subscriptions: list[TypedSubscription[Any]] = []
        self._table_values = NodeParameters(self, self.PARAMETERS + COMMON_PARAMETERS, self.parameters_changed)
        if not _FRAME_PREFIX.fullmatch(self.value("frame_prefix")):
            raise BadParameterError(f"parameter frame_prefix is no frame name: {self.value('frame_prefix')!r}")
        self.diagnostics = DiagnosticsPublisher(self)
        for sentence in self._table_values.unknown:
            self.get_logger().warning(f"{sentence}; ignored")
            self.diagnostics.report("parameters", Level.WARN, f"{sentence}; ignored")
        self._monitor = InputMonitor(FRESH_S)
        self._failures = CallbackFailures(self.get_logger().error, self._on_failure)
        self._failed_s = float("-inf")
        self.diagnostics.add_source(self._report_health)
        self.diagnostics.add_source(self._report_connections)

    # What subclasses may override.

    def safe_stop(self) -> None:
        """Called once before the node is destroyed, while it can still publish: stop what moves."""

    def parameters_changed(self, changed: dict[str, Any]) -> None:
        """Called with the new values after live parameters were set."""

    def idle_work(self) -> float:
        """Work between callbacks, for a node that is not driven by messages alone; overriding it turns it on.

        Returns the seconds after which it wants to be called again at the latest; callbacks come in between.
        """
        raise NotImplementedError

    # What subclasses use.

    def value(self, name: str) -> Any:
        """Value of a parameter."""
        return value_or_ros(self._table_values, self, name)

    def tuning(self, settings_class: type) -> dict[str, Any]:
        """Parameters that are tunable fields of a settings dataclass, as keyword arguments for it."""
        return {setting.name: self.value(setting.name) for setting in settings_of(settings_class)}

    def frame(self, name: str) -> str:
        """``name`` with the frame prefix."""
        return f"{self.value('frame_prefix')}{name}"

    def publish_typed(
        self, message_type: type, topic: str, convert: Callable[..., Any], qos: QoSProfile
    ) -> TypedPublisher:
        """Publisher of what ``convert(value)`` makes; ``.publish(value)`` sends."""
        publisher = TypedPublisher(self, message_type, topic, convert, qos)
        self.typed_publishers.append(publisher)
        return publisher

    def subscribe_typed(
        self,
        message_type: type,
        topic: str,
        convert: Callable[[Any], Value],
        callback: Callable[[Value], None],
        qos: QoSProfile,
        *,
        expected_frame: str | None = None,
    ) -> TypedSubscription[Value]:
        """Call ``callback`` with what ``convert`` makes of each message; messages that it rejects are counted."""
        subscription = TypedSubscription(
            self,
            message_type,
            topic,
            convert,
            callback,
            qos,
            monitor=self._monitor,
            failures=self._failures,
            on_rejection=self._report_health,
            expected_frame=expected_frame,
        )
        self.typed_subscriptions.append(subscription)
        return subscription

    def serve(self, service_type: type, name: str, handler: Callable[[Any, Any], Any]) -> Service:
        """Serve ``handler(request, response) -> response``; its exceptions become refusals with the reason."""
        return self.create_service(service_type, name, answering(handler, self._failures))

    def every_wall(self, period_s: float, callback: Callable[[], None]) -> Timer:
        """Call ``callback`` every ``period_s`` of wall time (a steady clock); for watchdogs, not for algorithms."""
        clock = Clock(clock_type=ClockType.STEADY_TIME)
        return self.create_timer(period_s, self._failures.guarded(callback), clock=clock)

    @cached_property
    def transforms(self) -> "TransformBroadcaster":
        """Broadcaster on tf and tf_static; made when first used."""
        from node_kit.transforms import TransformBroadcaster

        return TransformBroadcaster(self)

    def request_exit(self, code: int, reason: str) -> None:
        """End the process in order: every node's `safe_stop`, then exit code ``code``; the reason is logged."""
        if self.exit_code is None:
            self.exit_code = code
            log = self.get_logger().info if code == 0 else self.get_logger().fatal
            log(reason)

    def note_failure(self, name: str, error: Exception) -> None:
        """Log and count an exception out of ``name``, as those of callbacks are."""
        self._failures.note(name, error)

    def _on_failure(self, _newest: str) -> None:
        self._failed_s = time.monotonic()
        self._report_failures()

    def _report_health(self) -> None:
        self.diagnostics.report("inputs", *self._monitor.summary(time.monotonic()))
        if self._failures.counts:
            self._report_failures()

    def _report_connections(self) -> None:
        """How many publishers each subscription hears; others wait for this before they start what must not be lost."""
        heard = {typed.ledger.topic: typed.subscription.get_publisher_count() for typed in self.typed_subscriptions}
        self.diagnostics.report("connections", Level.OK, "publishers heard", heard)

    def _report_failures(self) -> None:
        """A failure is an error while it is fresh and a warning for good."""
        fresh = time.monotonic() - self._failed_s < FRESH_S
        level = Level.ERROR if fresh else Level.WARN
        self.diagnostics.report("callbacks", level, self._failures.newest, self._failures.counts)
