"""Node navigator: drives to goals on a map."""

import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path as FilePath
from typing import Any

import numpy as np
from geometry_msgs.msg import PoseStamped
from nav_msgs.msg import OccupancyGrid, Path
from nav_msgs.msg import Odometry as OdometryMessage
from sensor_msgs.msg import LaserScan as LaserScanMessage
from std_msgs.msg import Bool
from std_srvs.srv import Trigger
from tf2_msgs.msg import TFMessage
from tracked_interfaces.msg import GoalReached as GoalReachedMessage
from tracked_interfaces.msg import Trajectory as TrajectoryMessage
from visualization_msgs.msg import MarkerArray

from node_kit import BadParameterError, Level, Parameter, ParameterTable, RejectedMessage, StackNode, qos, run
from node_kit.conversions import (
    bool_from_message,
    goal_reached_to_message,
    movers_to_message,
    occupancy_grid_from_message,
    odometry_from_message,
    path_to_message,
    pose_stamped_from_message,
    scan_from_message,
    trajectory_to_message,
)
from node_kit.conversions.transform import transforms_from_message
from node_kit.rigid_transform import StampedTransform
from node_kit.rotations import yaw_from_quaternion
from tracked_description import ROBOT_FILE, load_robot
from tracked_localization.matching.scan_alignment import AlignedScan, ScanAlignment, ScanRefused
from tracked_navigation.band import BandSettings, TimedElasticBand
from tracked_navigation.movers.mover_tracker import MoverSettings
from tracked_navigation.navigator import Finished, Navigator, NavigatorOutput, NavigatorSettings, Outcome
from tracked_navigation.nodes.goal_actions import GoalActions
from tracked_navigation.planning.costmap import CostSettings
from tracked_navigation.planning.zones import Zones, load_zones
from tracked_types import GoalReached, LaserScan, OccupancyMap, Odometry, Pose2, StampedPose, seconds_between

ZONES = Parameter("zones", "", "YAML file of zones of the map: forbidden, slow, preferred; empty for none")
GOALS = Parameter("goals", (0.0,), "Drive here at once: x (m), y (m), yaw (rad) of each goal, one after the other.")
TIMEOUT = Parameter("transform_timeout_s", 1.0, "map -> odom older than this is none", unit="s", low=0.1, high=60.0)
PARAMETERS = ParameterTable.from_settings(
    NavigatorSettings,
    BandSettings,
    CostSettings,
    MoverSettings,
    extra=(ZONES, GOALS, TIMEOUT, qos.RELIABLE_SENSORS, Parameter(*ROBOT_FILE)),
)


class NavigatorNode(StackNode):
    """Subscribes map, scan, odom, tf, localised, goal_pose; publishes reference_trajectory, plan, local_plan, movers.

    Serves cancel_navigation and the actions navigate_to_pose and navigate_through_poses.
    """

    NAME = "navigator"
    PARAMETERS = PARAMETERS

    def __init__(self) -> None:
        super().__init__()
        robot = load_robot(self.value("robot_file"))
        band = BandSettings.from_robot(robot, **self.tuning(BandSettings))
        self._map_frame, self._odom_frame = self.frame(band.frame_id), self.frame(robot.frames.odom)
        zones = load_zones(FilePath(self.value(ZONES.name))) if self.value(ZONES.name) else Zones()
        self.navigator = Navigator(
            NavigatorSettings(**self.tuning(NavigatorSettings)),
            TimedElasticBand(replace(band, frame_id=self._map_frame)),
            CostSettings.from_robot(robot, **self.tuning(CostSettings)),
            MoverSettings(**self.tuning(MoverSettings)),
            zones,
        )
        self.alignment = ScanAlignment.of_robot(robot)
        self._first_goals = _goals_of(self.value(GOALS.name))
        self._localised: bool | None = None
        self._odom_in_map: tuple[int, Pose2] | None = None
        self.reference = self.publish_typed(TrajectoryMessage, "reference_trajectory", trajectory_to_message, qos.STATE)
        self.plan = self.publish_typed(Path, "plan", path_to_message, qos.LATCHED)
        self.local_plan = self.publish_typed(Path, "local_plan", path_to_message, qos.STATE)
        self.movers = self.publish_typed(MarkerArray, "movers", movers_to_message, qos.STATE)
        self.arrival = self.publish_typed(GoalReachedMessage, "goal_reached", goal_reached_to_message, qos.LATCHED)
        self._subscribe(self.frame(robot.frames.lidar))
        self.serve(Trigger, "cancel_navigation", self.on_cancel)
        self.actions = GoalActions(self, self._map_frame, self.go, self.navigator.cancel)
        self._report("no goal")

    def _subscribe(self, lidar_frame: str) -> None:
        sensor = qos.sensor(reliable=self.value(qos.RELIABLE_SENSORS.name))
        self.subscribe_typed(
            OccupancyGrid,
            "map",
            occupancy_grid_from_message,
            self.on_map,
            qos.LATCHED,
            expected_frame=self._map_frame,
        )
        self.subscribe_typed(
            LaserScanMessage, "scan", scan_from_message, self.on_scan, sensor, expected_frame=lidar_frame
        )
        self.subscribe_typed(
            OdometryMessage,
            "odom",
            odometry_from_message,
            self.on_odometry,
            qos.STATE,
            expected_frame=self._odom_frame,
        )
        self.subscribe_typed(TFMessage, "tf", transforms_from_message, self.on_transforms, qos.STATE)
        self.subscribe_typed(Bool, "localised", bool_from_message, self.on_localised, qos.LATCHED)
        self.subscribe_typed(PoseStamped, "goal_pose", pose_stamped_from_message, self.on_goal, qos.STATE)

    def go(self, goals: Sequence[Pose2]) -> None:
        """Drive past the goals, poses in the map's frame; raises ValueError if there is no map."""
        self.navigator.go(goals)
        self._first_goals = []

    def on_map(self, occupancy_map: OccupancyMap) -> None:
        """A map in, instead of the one before."""
        self.navigator.set_map(occupancy_map)
        if self._first_goals:
            self.go(self._first_goals)

    def on_goal(self, goal: StampedPose) -> None:
        """A goal from a viewer; it pre-empts."""
        goals = self.actions.goals_of([goal])
        self.actions.preempt()
        try:
            self.go(goals)
        except ValueError as error:
            raise RejectedMessage(str(error)) from error

    def on_cancel(self, _request: Any, response: Any) -> Any:
        """Brake, and forget the goal."""
        response.success = self.navigator.busy
        response.message = "brakes" if response.success else "there is no goal"
        self.navigator.cancel()
        return response

    def on_localised(self, localised: bool) -> None:
        """Whether the robot knows where it is, by the word of whoever localises it."""
        self._localised = localised

    def on_transforms(self, transforms: list[StampedTransform]) -> None:
        """Of all transforms, that of the odometry in the map."""
        for each in transforms:
            if each.parent == self._map_frame and each.child == self._odom_frame:
                x, y, _ = each.transform.translation_m
                self._odom_in_map = each.stamp_ns, Pose2(x, y, yaw_from_quaternion(*each.transform.quaternion))

    def on_scan(self, scan: LaserScan) -> None:
        """One scan in."""
        try:
            self._see(self.alignment.add_scan(scan))
        except ScanRefused as refusal:
            raise RejectedMessage(str(refusal)) from refusal

    def on_odometry(self, odometry: Odometry) -> None:
        """One odometry in; at 5 Hz instants a piece of reference out."""
        self._see(self.alignment.add_odometry(odometry))
        output = self.navigator.update(odometry, self._known(odometry.stamp_ns))
        if output is not None:
            self._tell(output)

    def _known(self, stamp_ns: int) -> Pose2 | None:
        """The odometry's frame in the map, if that is known now."""
        if self._localised is False or self._odom_in_map is None:
            return None
        told_ns, pose = self._odom_in_map
        return pose if abs(seconds_between(stamp_ns, told_ns)) <= self.value(TIMEOUT.name) else None

    def _see(self, scans: list[AlignedScan]) -> None:
        for scan in scans:
            known = self._known(scan.points.stamp_ns)
            if known is not None:
                self.navigator.see(scan.points, known.compose(scan.odom_pose))

    def _tell(self, output: NavigatorOutput) -> None:
        if output.reference is not None:
            self.reference.publish(output.reference)
        if output.path is not None:
            self.plan.publish(output.path, output.stamp_ns, self._map_frame)
        if output.band is not None and output.band.trajectory is not None:
            self.local_plan.publish(output.band.trajectory.states, output.stamp_ns, self._map_frame)
        if output.movers:
            self.movers.publish(output.movers)
        self.actions.update(output.progress, output.stamp_ns)
        if output.finished is not None:
            self._end(output.finished)
        elif output.progress is not None:
            waits = output.progress.waits
            self._report(waits or "on the way", Level.WARN if waits else Level.OK, left_m=output.progress.left_m)

    def _end(self, finished: Finished) -> None:
        self.actions.end(finished)
        if finished.outcome is Outcome.SUCCEEDED:
            self.arrival.publish(
                GoalReached(finished.stamp_ns, "goal", finished.position_error_m, finished.yaw_error_rad)
            )
            self.get_logger().info("goal reached")
            self._report("goal reached")
        else:
            sentence = f"goal {finished.outcome.value}: {finished.reason}"
            if finished.nearest is not None:
                sentence += "; nearest reachable place: x {:.2f} m, y {:.2f} m".format(*finished.nearest)
            self.get_logger().warning(sentence)
            self._report(sentence, Level.WARN)

    def _report(self, sentence: str, level: Level = Level.OK, **values: object) -> None:
        values["scans without odometry"] = self.alignment.uncovered
        self.diagnostics.report("navigation", level, sentence, values)


def _goals_of(numbers: Sequence[float]) -> list[Pose2]:
    if len(numbers) <= 1:
        return []
    if len(numbers) % 3 or not np.isfinite(numbers).all():
        raise BadParameterError(f"parameter {GOALS.name} must be x, y, yaw of each goal, got {list(numbers)}")
    return [Pose2(*numbers[index : index + 3]) for index in range(0, len(numbers), 3)]


def main() -> int:
    """Run the node; the exit code of the process."""
    return run(NavigatorNode)


if __name__ == "__main__":
    sys.exit(main())
