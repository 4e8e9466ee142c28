"""Actions navigate_to_pose and navigate_through_poses: one request at a time, a newer one pre-empts."""

from collections.abc import Callable, Sequence
from typing import Any

from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.task import Future
from tracked_interfaces.action import NavigateThroughPoses, NavigateToPose

from node_kit import RejectedMessage, StackNode
from node_kit.conversions import fill_header, pose_stamped_from_message, pose_stamped_to_message
from tracked_navigation.navigator import Finished, Outcome, Progress
from tracked_types import NANOSECONDS_PER_SECOND, Pose2, StampedPose

_CODES = {Outcome.SUCCEEDED: 0, Outcome.CANCELLED: 1, Outcome.ABORTED: 2}
_MOST_POSES = 1000


class GoalActions:
    """Turns action goals into requests and a request's progress and end into feedback and result.

    go: takes goals in the map's frame; raises ValueError with the reason if they cannot be driven to.
    cancel: brakes, and lets the request end as cancelled.
    """

    def __init__(
        self, node: StackNode, map_frame: str, go: Callable[[Sequence[Pose2]], None], cancel: Callable[[], None]
    ) -> None:
        self._node, self._map_frame, self._go, self._cancel = node, map_frame, go, cancel
        self._active: tuple[Any, Future] | None = None
        self._servers = [
            ActionServer(
                node,
                kind,
                name,
                self._execute,
                goal_callback=self._on_goal,
                cancel_callback=lambda _handle: CancelResponse.ACCEPT,
            )
            for kind, name in ((NavigateToPose, "navigate_to_pose"), (NavigateThroughPoses, "navigate_through_poses"))
        ]

    def goals_of(self, stamped: Sequence[StampedPose]) -> list[Pose2]:
        """The poses; raises RejectedMessage if one is in another frame than the map's."""
        for number, each in enumerate(stamped, start=1):
            if each.frame_id != self._map_frame:
                raise RejectedMessage(f"frame of goal {number} is {each.frame_id}, not {self._map_frame}")
        return [each.pose for each in stamped]

    def update(self, progress: Progress | None, stamp_ns: int) -> None:
        """Feedback of the request under way; cancels it if its client asks for that."""
        if self._active is None:
            return
        handle, _ = self._active
        if handle.is_cancel_requested:
            self._cancel()
        if progress is not None:
            handle.publish_feedback(self._feedback(handle, progress, stamp_ns))

    def end(self, finished: Finished) -> None:
        """The request under way has ended."""
        if self._active is not None:
            (_, future), self._active = self._active, None
            future.set_result(finished)

    def preempt(self) -> None:
        """Another request has come, by whatever way."""
        self.end(Finished(0, Outcome.ABORTED, "pre-empted by another goal"))

    def _on_goal(self, request: Any) -> GoalResponse:
        try:
            self._read(request)
        except RejectedMessage as rejection:
            self._node.get_logger().warning(f"goal refused: {rejection.reason}")
            return GoalResponse.REJECT
        return GoalResponse.ACCEPT

    def _read(self, request: Any) -> list[Pose2]:
        messages = [request.pose] if hasattr(request, "pose") else request.poses
        if not 1 <= len(messages) <= _MOST_POSES:
            raise RejectedMessage(f"number of poses is {len(messages)}, expected 1 to {_MOST_POSES}")
        return self.goals_of([pose_stamped_from_message(message) for message in messages])

    async def _execute(self, handle: Any) -> Any:
        self.preempt()
        future: Future = Future()
        try:
            self._go(self._read(handle.request))
        except ValueError as error:
            future.set_result(Finished(0, Outcome.ABORTED, str(error)))
        else:
            self._active = handle, future
        finished: Finished = await future
        if finished.outcome is Outcome.SUCCEEDED:
            handle.succeed()
        elif finished.outcome is Outcome.CANCELLED and handle.is_cancel_requested:
            handle.canceled()
        else:
            handle.abort()
        return self._result(handle, finished)

    def _result(self, handle: Any, finished: Finished) -> Any:
        result = _kind_of(handle).Result()
        result.error_code, result.error_msg = _CODES[finished.outcome], finished.reason
        result.position_error, result.yaw_error = float(finished.position_error_m), float(finished.yaw_error_rad)
        if finished.nearest is not None:
            fill_header(result.nearest_pose.header, finished.stamp_ns, self._map_frame)
            result.nearest_pose.pose.position.x, result.nearest_pose.pose.position.y = finished.nearest
        return result

    def _feedback(self, handle: Any, progress: Progress, stamp_ns: int) -> Any:
        feedback = _kind_of(handle).Feedback()
        pose_stamped_to_message(StampedPose(stamp_ns, self._map_frame, progress.pose), feedback.current_pose)
        _fill_duration(feedback.navigation_time, progress.since_s)
        _fill_duration(feedback.estimated_time_remaining, progress.left_s)
        feedback.number_of_recoveries = min(int(progress.replans), 32767)
        feedback.distance_remaining = float(progress.left_m)
        feedback.number_of_poses_remaining = min(progress.goals_left, 32767)
        feedback.waits = progress.waits
        return feedback


def _kind_of(handle: Any) -> Any:
    return NavigateToPose if hasattr(handle.request, "pose") else NavigateThroughPoses


def _fill_duration(duration: Any, seconds: float) -> None:
    duration.sec, duration.nanosec = divmod(max(round(seconds * NANOSECONDS_PER_SECOND), 0), NANOSECONDS_PER_SECOND)
