"""tracked_interfaces/SolverStatus."""

from tracked_interfaces.msg import SolverStatus as SolverStatusMessage

from node_kit.conversions.checks import require_finite, require_not_negative
from node_kit.conversions.headers import fill_header, stamp_from_message
from tracked_types import SolverStatus


def solver_status_from_message(message: SolverStatusMessage) -> SolverStatus:
    """Status of one tick; a failed one may carry any cost.

    Raises
    ------
    RejectedMessage: the stamp or the CPU time cannot be used, or a converged tick has no finite cost.
    """
    return SolverStatus(
        stamp_from_message(message.header.stamp),
        message.layer,
        bool(message.ok),
        message.reason,
        int(message.iterations),
        require_finite("cost", message.cost) if message.ok else message.cost,
        require_not_negative("cpu_time", message.cpu_time),
    )


def solver_status_to_message(
    status: SolverStatus, into: SolverStatusMessage | None = None, *, frame_id: str = ""
) -> SolverStatusMessage:
    """Message of one tick."""
    message = SolverStatusMessage() if into is None else into
    fill_header(message.header, status.stamp_ns, frame_id)
    message.layer, message.ok, message.reason = status.layer, bool(status.ok), status.reason
    message.iterations = int(status.iterations)
    message.cost, message.cpu_time = float(status.cost), float(status.cpu_time_s)
    return message
