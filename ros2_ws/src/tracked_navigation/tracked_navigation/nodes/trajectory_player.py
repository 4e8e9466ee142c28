"""Node trajectory_player: plays a named shape or a file on the stamps of the odometry."""

import sys

from nav_msgs.msg import Odometry as OdometryMessage
from tracked_interfaces.msg import GoalReached as GoalReachedMessage
from tracked_interfaces.msg import Trajectory as TrajectoryMessage

from node_kit import Level, Parameter, ParameterTable, StackNode, qos, run
from node_kit.conversions import goal_reached_to_message, odometry_from_message, trajectory_to_message
from tracked_description import ROBOT_FILE, load_robot
from tracked_navigation import Phase, PlayerSettings, ReferenceSettings, TrajectoryPlayer, make_reference
from tracked_navigation.shape_settings import ShapeSettings
from tracked_types import Odometry

PARAMETERS = ParameterTable.from_settings(
    ReferenceSettings, ShapeSettings, PlayerSettings, extra=(Parameter(*ROBOT_FILE),)
)


class TrajectoryPlayerNode(StackNode):
    """Subscribes odom; publishes reference_trajectory at 5 Hz and goal_reached once."""

    NAME = "trajectory_player"
    PARAMETERS = PARAMETERS

    def __init__(self) -> None:
        super().__init__()
        robot = load_robot(self.value("robot_file"))
        reference = make_reference(
            robot,
            ReferenceSettings(**self.tuning(ReferenceSettings)),
            ShapeSettings(**self.tuning(ShapeSettings)),
        )
        self.player = TrajectoryPlayer(PlayerSettings(**self.tuning(PlayerSettings)), reference)
        self.reference = self.publish_typed(TrajectoryMessage, "reference_trajectory", trajectory_to_message, qos.STATE)
        self.arrival = self.publish_typed(GoalReachedMessage, "goal_reached", goal_reached_to_message, qos.LATCHED)
        self.subscribe_typed(
            OdometryMessage,
            "odom",
            odometry_from_message,
            self.on_odometry,
            qos.STATE,
            expected_frame=self.frame(robot.frames.odom),
        )
        self._report()

    def on_odometry(self, odometry: Odometry) -> None:
        """One odometry in; at 5 Hz instants one piece of reference out."""
        output = self.player.update(odometry)
        if output.reference is not None:
            self.reference.publish(output.reference)
            self._report()
        if output.reached is not None:
            self.arrival.publish(output.reached)
            self._report()

    def _report(self) -> None:
        player = self.player
        level = Level.WARN if player.phase is Phase.NOT_REACHED else Level.OK
        self.diagnostics.report(
            "trajectory",
            level,
            player.phase.value,
            {
                "trajectory": player.name,
                "progress": f"{player.progress:.3f}",
                "ignored_odometry": str(player.ignored_odometry),
            },
        )


def main() -> int:
    """Run the node; the exit code of the process."""
    return run(TrajectoryPlayerNode)


if __name__ == "__main__":
    sys.exit(main())
