"""Diagnostics of both layers."""

from node_kit import Level, StackNode
from tracked_types import SolverStatus


class StatusReport:
    """Puts the outcome of each tick, and how the solver runs, on a node's diagnostics.

    Parameters
    ----------
    node: whose diagnostics.
    interpreter_reason: why the solver is not compiled, "" if it is.
    """

    def __init__(self, node: StackNode, interpreter_reason: str) -> None:
        self._node = node
        self._failures = 0
        self._overdue = 0
        level = Level.WARN if interpreter_reason else Level.OK
        node.diagnostics.report("solver code", level, interpreter_reason or "compiled", {})

    def note(self, status: SolverStatus, **values: object) -> None:
        """The outcome of one tick and further values to show."""
        self._failures += not status.ok
        self._node.diagnostics.report(
            "control",
            Level.OK if status.ok else Level.WARN,
            status.reason or "converged",
            {
                "iterations": status.iterations,
                "cost": f"{status.cost:.3g}",
                "cpu_ms": f"{1e3 * status.cpu_time_s:.3f}",
                "failed_ticks": self._failures,
                **values,
            },
        )

    def note_overdue(self, waiting: int) -> None:
        """So many odometries are ticked without what lock-step promises them."""
        self._overdue += waiting
        message = f"{self._overdue} odometries have waited in vain: time is not locked to the commands"
        self._node.get_logger().warning(message)
        self._node.diagnostics.report("lock step", Level.WARN, message)
