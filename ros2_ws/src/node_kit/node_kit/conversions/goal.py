"""tracked_interfaces/GoalReached."""

from tracked_interfaces.msg import GoalReached as GoalReachedMessage

from node_kit.conversions.checks import require_finite, require_not_negative
from node_kit.conversions.headers import fill_header, stamp_from_message
from tracked_types import GoalReached


def goal_reached_from_message(message: GoalReachedMessage) -> GoalReached:
    """Arrival with its remaining errors.

    Raises
    ------
    RejectedMessage: the stamp or an error cannot be used.
    """
    return GoalReached(
        stamp_from_message(message.header.stamp),
        message.trajectory,
        require_not_negative("position_error", message.position_error),
        require_finite("yaw_error", message.yaw_error),
    )


def goal_reached_to_message(
    goal: GoalReached, into: GoalReachedMessage | None = None, *, frame_id: str = ""
) -> GoalReachedMessage:
    """Message in the trajectory's frame ``frame_id``."""
    message = GoalReachedMessage() if into is None else into
    fill_header(message.header, goal.stamp_ns, frame_id)
    message.trajectory = goal.trajectory
    message.position_error, message.yaw_error = float(goal.position_error_m), float(goal.yaw_error_rad)
    return message
