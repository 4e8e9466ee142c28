"""Eyes of the bringup in the graph: who is there, how far simulated time is, how the robot does.

It looks when asked and spins nothing: each subscription keeps its newest message, taken on demand, so
watching costs next to nothing however fast the topics are.
"""

import contextlib
import time
from collections import Counter
from collections.abc import Callable, Iterator
from typing import Any

import rclpy
from diagnostic_msgs.msg import DiagnosticArray
from nav_msgs.msg import Odometry
from rclpy.context import Context
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rclpy.task import Future
from rosgraph_msgs.msg import Clock
from tracked_interfaces.msg import GoalReached, SlipEstimate, SolverStatus, Trajectory
from tracked_interfaces.srv import InjectFault, SetSimulationState

from node_kit import RejectedMessage
from node_kit.conversions import (
    clock_from_message,
    fill_stamp,
    goal_reached_from_message,
    odometry_from_message,
    slip_from_message,
    solver_status_from_message,
    trajectory_from_message,
)
from tracked_bringup.graph_plan import GraphPlan, NodePlan
from tracked_bringup.live_state import LiveState
from tracked_report.scenario import Fault
from tracked_types import to_nanoseconds

_NEWEST = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
_LATCHED = QoSProfile(depth=1, reliability=ReliabilityPolicy.RELIABLE, durability=DurabilityPolicy.TRANSIENT_LOCAL)
_SERVICE_LIMIT_S = 5.0


class GraphMonitor:
    """A node of the bringup's own in the domain of the run; close it when done."""

    def __init__(self, plan: GraphPlan, domain: int) -> None:
        self._plan = plan
        self._context = Context()
        rclpy.init(args=[], context=self._context, domain_id=domain)
        self._node = Node(
            "bringup", context=self._context, namespace=plan.namespace or None, start_parameter_services=False
        )
        self.state = LiveState()
        self._sources: list[tuple[Any, Callable[[Any], Any], Callable[[Any], None]]] = []
        self._watch(Clock, "clock", clock_from_message, self.state.note_time, _NEWEST)
        self._watch(Odometry, "odom", odometry_from_message, self.state.note_odometry, _NEWEST)
        self._watch(SlipEstimate, "slip", slip_from_message, self.state.note_slip, _NEWEST)
        self._watch(Trajectory, "reference_trajectory", trajectory_from_message, self.state.note_reference, _NEWEST)
        self._watch(GoalReached, "goal_reached", goal_reached_from_message, self.state.note_goal, _LATCHED)
        self._diagnostics = self._node.create_subscription(DiagnosticArray, "diagnostics", _never_called, 200)
        self._heard: dict[str, dict[str, int]] = {}
        for layer in ("upper", "lower"):
            self._watch(
                SolverStatus, f"{layer}_nmpc/status", solver_status_from_message, self.state.note_status, _NEWEST
            )

    def close(self) -> None:
        """Leave the graph."""
        self._node.destroy_node()
        rclpy.shutdown(context=self._context)

    def refresh(self) -> LiveState:
        """The state after the newest messages."""
        for subscription, convert, note in self._sources:
            for message in self._take_all(subscription):
                # What is rejected here is counted by the nodes and the recorder.
                with contextlib.suppress(RejectedMessage):
                    note(convert(message))
        return self.state

    def missing(self, nodes: tuple[NodePlan, ...]) -> list[str]:
        """Endpoints that these nodes should have and that are not in the graph yet, in words."""
        lacking = []
        for node in nodes:
            published = [topic for topic in node.publishes if not self._has_endpoint(node.name, topic, True)]
            subscribed = [topic for topic in node.entry.subscribes if not self._has_endpoint(node.name, topic, False)]
            if published or subscribed:
                lacking.append(f"{node.name} ({', '.join([*published, *subscribed])})")
        return lacking

    def unconnected(self) -> list[str]:
        """Subscriptions that do not hear every publisher yet, by the word of the nodes themselves, in words.

        An endpoint in the graph is not a connection: nodes find one another in their own time.
        """
        for message in self._take_all(self._diagnostics):
            for status in message.status:
                node, _, task = status.name.partition(": ")
                if task == "connections":
                    self._heard[node] = {pair.key: int(pair.value) for pair in status.values}
        lacking = []
        for node in self._plan.nodes:
            heard = self._heard.get(node.name, {})
            deaf = [t for t in node.entry.subscribes if heard.get(t, 0) < self._plan.publishers_of(t)]
            if deaf:
                lacking.append(f"{node.name} (hears no {', '.join(deaf)})")
        return lacking

    def doubles(self) -> list[str]:
        """Nodes of the plan that are in the graph more than once, in words: another run uses the same domain."""
        found = Counter(self._node.get_node_names_and_namespaces())
        namespace = f"/{self._plan.namespace}"
        names = [node.name for node in self._plan.nodes if found[node.name, namespace] > 1]
        return [f"there is another {self._plan.full_name(name)}" for name in names]

    def set_playing(self) -> str | None:
        """Let simulated time run; why it does not, or None."""
        request = SetSimulationState.Request(state=SetSimulationState.Request.PLAYING)
        return self._call(SetSimulationState, "set_simulation_state", request)

    def inject(self, fault: Fault) -> str | None:
        """Announce a fault to the simulator, to act from its time on; why that failed, or None."""
        request = InjectFault.Request(
            sensor=fault.target, kind=fault.kind, duration=float(fault.duration_s or 0.0), magnitude=float(fault.value)
        )
        fill_stamp(request.start, to_nanoseconds(fault.at_s))
        return self._call(InjectFault, "inject_fault", request)

    def _watch(
        self, kind: type, topic: str, convert: Callable[[Any], Any], note: Callable[[Any], None], qos: QoSProfile
    ) -> None:
        subscription = self._node.create_subscription(kind, topic, _never_called, qos)
        self._sources.append((subscription, convert, note))

    def _take_all(self, subscription: Any) -> Iterator[Any]:
        while True:
            with subscription.handle:
                taken = subscription.handle.take_message(subscription.msg_type, subscription.raw)
            if taken is None:
                return
            yield taken[0]

    def _has_endpoint(self, node: str, topic: str, publishes: bool) -> bool:
        name = self._plan.full_name(topic)
        query = self._node.get_publishers_info_by_topic if publishes else self._node.get_subscriptions_info_by_topic
        namespace = f"/{self._plan.namespace}"
        return any(info.node_name == node and info.node_namespace == namespace for info in query(name))

    def _call(self, kind: Any, name: str, request: Any) -> str | None:
        client = self._node.create_client(kind, name)
        try:
            if not client.wait_for_service(timeout_sec=_SERVICE_LIMIT_S):
                return f"no service {self._plan.full_name(name)}"
            result = self._answer(client.call_async(request))
        finally:
            self._node.destroy_client(client)
        if result is None:
            return f"{self._plan.full_name(name)} does not answer"
        outcome = result.result
        return None if outcome.result == type(outcome).OK else outcome.error_message

    def _answer(self, future: Future) -> Any:
        """Result of a call, without serving the subscriptions (`refresh` takes their messages)."""
        deadline_s = time.monotonic() + _SERVICE_LIMIT_S
        executor = rclpy.executors.SingleThreadedExecutor(context=self._context)
        executor.add_node(self._node)
        try:
            while not future.done() and time.monotonic() < deadline_s:
                executor.spin_once(timeout_sec=0.1)
        finally:
            executor.remove_node(self._node)
            executor.shutdown()
        return future.result() if future.done() else None


def _never_called(_message: Any) -> None:
    """Messages are taken by `GraphMonitor.refresh`; what an executor takes meanwhile is old news."""
