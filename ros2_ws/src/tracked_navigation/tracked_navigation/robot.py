"""Drive the robot from a Python program: goals, feedback, cancel, result.

    from tracked_navigation.robot import Robot

    with Robot() as robot:
        drive = robot.go_to(6.0, 4.4, 1.57)
        while not drive.done(timeout_s=1.0):
            print(f"{drive.distance_remaining_m:.1f} m left {drive.waits}")
        print(drive.result)

Importing this module needs rclpy.
"""

import time
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import rclpy
from geometry_msgs.msg import PoseStamped
from rclpy.action import ActionClient
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from tracked_interfaces.action import NavigateThroughPoses, NavigateToPose

from node_kit.conversions import pose_stamped_to_message
from tracked_types import Pose2, StampedPose

_ANSWER_LIMIT_S = 10.0


class NavigatorUnreachable(RuntimeError):
    """No navigator answers."""


@dataclass(frozen=True, slots=True)
class DriveResult:
    """How a drive ended. succeeded: the robot rests at the goal. reason: why not, in words. nearest: x, y (m) of the
    reachable place nearest to the goal, if there is no way to it."""

    succeeded: bool
    reason: str
    position_error_m: float
    yaw_error_rad: float
    nearest: tuple[float, float] | None


class Drive:
    """One request under way. distance_remaining_m and waits are those of the newest feedback."""

    def __init__(self, robot: "Robot", handle: Any) -> None:
        self._robot, self._handle = robot, handle
        self._finished = handle.get_result_async()
        self.distance_remaining_m = float("nan")
        self.waits = ""
        self.result: DriveResult | None = None

    def done(self, timeout_s: float = 0.0) -> bool:
        """Whether it has ended; waits so long for that."""
        if self.result is None and self._robot.spin_until(self._finished.done, timeout_s):
            self.result = _result_of(self._finished.result())
        return self.result is not None

    def wait(self, timeout_s: float) -> DriveResult:
        """The result.

        Raises
        ------
        TimeoutError: it has not ended in time; it goes on.
        """
        if not self.done(timeout_s) or self.result is None:
            raise TimeoutError(f"the drive has not ended within {timeout_s:g} s")
        return self.result

    def cancel(self) -> None:
        """Brake; the drive ends soon after, not succeeded."""
        self._handle.cancel_goal_async()

    def note(self, message: Any) -> None:
        """Take a feedback message in."""
        self.distance_remaining_m, self.waits = message.feedback.distance_remaining, message.feedback.waits


class Robot:
    """Client of a navigator. namespace: of the robot. context: an rclpy context, by default one of its own."""

    def __init__(self, namespace: str = "", map_frame: str = "map", context: Context | None = None) -> None:
        self._own_context = context is None
        self._context = context or Context()
        if self._own_context:
            rclpy.init(context=self._context)
        self._node = rclpy.create_node("robot_client", namespace=namespace or None, context=self._context)
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self._node)
        self._map_frame = map_frame
        self._clients = {
            kind: ActionClient(self._node, kind, name)
            for kind, name in ((NavigateToPose, "navigate_to_pose"), (NavigateThroughPoses, "navigate_through_poses"))
        }

    def __enter__(self) -> "Robot":
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Leave the graph; a drive under way goes on."""
        self._executor.shutdown()
        self._node.destroy_node()
        if self._own_context:
            self._context.try_shutdown()

    def go_to(self, x_m: float, y_m: float, yaw_rad: float) -> Drive:
        """Drive to a pose of the map.

        Raises
        ------
        NavigatorUnreachable: nobody answers within 10 s.
        ValueError: the navigator refuses the goal.
        """
        return self._ask(NavigateToPose, NavigateToPose.Goal(pose=self._stamped(Pose2(x_m, y_m, yaw_rad))))

    def go_through(self, poses: Sequence[tuple[float, float, float]]) -> Drive:
        """Drive past poses (x, y in m, yaw in rad) of the map and stop at the last; raises as `go_to`."""
        goal = NavigateThroughPoses.Goal(poses=[self._stamped(Pose2(*pose)) for pose in poses])
        return self._ask(NavigateThroughPoses, goal)

    def spin_until(self, condition: Any, timeout_s: float) -> bool:
        """Serve messages until the condition holds; whether it does."""
        deadline_s = time.monotonic() + timeout_s
        while not condition():
            left_s = deadline_s - time.monotonic()
            if left_s < 0.0:
                return False
            self._executor.spin_once(timeout_sec=min(left_s, 0.1))
        return True

    def _ask(self, kind: Any, goal: Any) -> Drive:
        client = self._clients[kind]
        drives: list[Drive] = []
        if not self.spin_until(client.server_is_ready, _ANSWER_LIMIT_S):
            raise NavigatorUnreachable(f"no navigator answers within {_ANSWER_LIMIT_S:g} s")

        def note(message: Any) -> None:
            for drive in drives:
                drive.note(message)

        answer = client.send_goal_async(goal, feedback_callback=note)
        if not self.spin_until(answer.done, _ANSWER_LIMIT_S):
            raise NavigatorUnreachable(f"the navigator does not answer within {_ANSWER_LIMIT_S:g} s")
        handle = answer.result()
        if not handle.accepted:
            raise ValueError("the navigator refuses the goal; its log says why")
        drives.append(Drive(self, handle))
        return drives[0]

    def _stamped(self, pose: Pose2) -> PoseStamped:
        return pose_stamped_to_message(StampedPose(0, self._map_frame, pose))


def _result_of(answer: Any) -> DriveResult:
    result = answer.result
    place = result.nearest_pose
    nearest = (place.pose.position.x, place.pose.position.y) if place.header.frame_id else None
    succeeded = result.error_code == NavigateToPose.Result.NONE
    return DriveResult(succeeded, result.error_msg, result.position_error, result.yaw_error, nearest)
