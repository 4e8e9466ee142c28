"""Node localiser: where the robot is on a map, from laser scans and odometry."""

import sys
from typing import Any

from geometry_msgs.msg import PoseWithCovarianceStamped
from nav_msgs.msg import OccupancyGrid
from nav_msgs.msg import Odometry as OdometryMessage
from sensor_msgs.msg import LaserScan as LaserScanMessage
from std_msgs.msg import Bool
from std_srvs.srv import Trigger

from node_kit import Level, Parameter, ParameterTable, RejectedMessage, StackNode, qos, run
from node_kit.conversions import (
    bool_to_message,
    occupancy_grid_from_message,
    odometry_from_message,
    pose_sample_from_message,
    pose_sample_to_message,
    scan_from_message,
)
from tracked_description import ROBOT_FILE, load_robot
from tracked_localization.localisation.global_search import SearchSettings
from tracked_localization.localisation.localiser import LocaliserSettings
from tracked_localization.localisation.odometry_anchor import AnchorSettings
from tracked_localization.localisation.robot_on_map import OnMap, Phase, RobotOnMap, RobotOnMapSettings
from tracked_localization.matching.scan_alignment import AlignedScan, ScanAlignment, ScanRefused
from tracked_localization.matching.scan_matcher import MatchSettings
from tracked_localization.nodes.map_frame import INITIAL_POSE, MAP_FRAME, TOLERANCE, MapToOdom, pose_of
from tracked_types import LaserScan, OccupancyMap, Odometry, PoseSample

USE_INITIAL_POSE = Parameter("use_initial_pose", False, "begin at initial_pose instead of searching the map")
SETTINGS = (RobotOnMapSettings, LocaliserSettings, MatchSettings, SearchSettings, AnchorSettings)
PARAMETERS = ParameterTable.from_settings(
    *SETTINGS,
    extra=(USE_INITIAL_POSE, INITIAL_POSE, MAP_FRAME, TOLERANCE, qos.RELIABLE_SENSORS, Parameter(*ROBOT_FILE)),
)
_LEVELS = {Phase.LOCALISED: Level.OK, Phase.LOST: Level.ERROR}


class LocaliserNode(StackNode):
    """Subscribes map, scan, odom, initialpose; publishes localisation_pose, localised and the transform map -> odom.

    With correct_odometry it also publishes pose, the scan's own word, for ekf. Serves relocalise, which searches the
    whole map.
    """

    NAME = "localiser"
    PARAMETERS = PARAMETERS

    def __init__(self) -> None:
        super().__init__()
        robot = load_robot(self.value("robot_file"))
        self._map_frame = self.frame(self.value(MAP_FRAME.name))
        odom_frame = self.frame(robot.frames.odom)
        self.alignment = ScanAlignment.of_robot(robot)
        settings, following, matching, searching, anchoring = (kind(**self.tuning(kind)) for kind in SETTINGS)
        self.robot = RobotOnMap(settings, following, matching, searching, anchoring, odom_frame)
        if self.value(USE_INITIAL_POSE.name):
            self.robot.set_pose(pose_of(self.value(INITIAL_POSE.name)))
        self.poses = self.publish_typed(
            PoseWithCovarianceStamped, "localisation_pose", pose_sample_to_message, qos.STATE
        )
        self.localised = self.publish_typed(Bool, "localised", bool_to_message, qos.LATCHED)
        self.measured = None
        if settings.correct_odometry:
            self.measured = self.publish_typed(PoseWithCovarianceStamped, "pose", pose_sample_to_message, qos.STATE)
        self.map_to_odom = MapToOdom(self, odom_frame)
        sensor = qos.sensor(reliable=self.value(qos.RELIABLE_SENSORS.name))
        frame, subscribe = self._map_frame, self.subscribe_typed
        subscribe(OccupancyGrid, "map", occupancy_grid_from_message, self.on_map, qos.LATCHED, expected_frame=frame)
        subscribe(
            LaserScanMessage,
            "scan",
            scan_from_message,
            self.on_scan,
            sensor,
            expected_frame=self.frame(robot.frames.lidar),
        )
        subscribe(
            OdometryMessage, "odom", odometry_from_message, self.on_odometry, qos.STATE, expected_frame=odom_frame
        )
        subscribe(
            PoseWithCovarianceStamped,
            "initialpose",
            pose_sample_from_message,
            self.on_initial_pose,
            qos.STATE,
            expected_frame=frame,
        )
        self.serve(Trigger, "relocalise", self.on_relocalise)
        self._told: Phase | None = None
        self._newest: OnMap | None = None
        self._tell()

    def on_map(self, occupancy_map: OccupancyMap) -> None:
        """A map in, instead of the one before."""
        try:
            self.robot.set_map(occupancy_map)
        except ValueError as error:
            raise RejectedMessage(str(error)) from error
        self._tell()

    def on_initial_pose(self, sample: PoseSample) -> None:
        """Somebody says where the robot is."""
        self.robot.set_pose(sample.pose, sample.covariance, self.alignment.odom_pose(sample.stamp_ns))
        self._tell()

    def on_odometry(self, odometry: Odometry) -> None:
        """One odometry in; what comes of the scans that waited for it."""
        self._take(self.alignment.add_odometry(odometry))
        self.robot.work(odometry.stamp_ns)
        if self.robot.phase is not self._told:
            self._tell()

    def on_scan(self, scan: LaserScan) -> None:
        """One scan in."""
        try:
            self._take(self.alignment.add_scan(scan))
        except ScanRefused as refusal:
            raise RejectedMessage(str(refusal)) from refusal

    def on_relocalise(self, _request: Any, response: Any) -> Any:
        """Search the whole map with the newest scan."""
        reason = self.robot.search_now()
        response.success, response.message = not reason, reason
        if not reason:
            pose = self.robot.candidates[0].pose
            response.message = f"the robot is at x {pose.x_m:.2f} m, y {pose.y_m:.2f} m, yaw {pose.yaw_rad:.2f} rad"
        self._tell()
        return response

    def _take(self, scans: list[AlignedScan]) -> None:
        for scan in scans:
            found = self.robot.add(scan)
            if found is None:
                continue
            self._newest = found
            pose = found.localised
            self.poses.publish(PoseSample(pose.stamp_ns, self._map_frame, pose.pose, pose.covariance))
            self.map_to_odom.send(found.odom_in_map, pose.stamp_ns)
            if self.measured is not None and found.measured is not None:
                self.measured.publish(found.measured)
            self._tell()

    def _tell(self) -> None:
        """Say how it is, and whether the robot is localised if that has changed."""
        phase, reason = self.robot.phase, self.robot.reason
        sentence = f"{phase.value}: {reason}" if reason else phase.value
        if (phase is Phase.LOCALISED) != (self._told is Phase.LOCALISED) or self._told is None:
            self.localised.publish(phase is Phase.LOCALISED)
        if phase is not self._told:
            if phase is Phase.LOCALISED:  # each level has a line of its own: rclpy remembers levels by place
                self.get_logger().info(sentence)
            else:
                self.get_logger().warning(sentence)
        self._told = phase
        values: dict[str, object] = {"scans without odometry": self.alignment.uncovered}
        if self._newest is not None:
            match = self._newest.localised.match
            if self.robot.unfollowed:
                values["odometry did not follow (is fuse_pose of ekf on?)"] = self.robot.unfollowed
            values |= {"scan on the map": f"{match.agreement:.0%}", "deviation (m)": match.deviation_m}
        self.diagnostics.report("localisation", _LEVELS.get(phase, Level.WARN), sentence, values)


def main() -> int:
    """Run the node; the exit code of the process."""
    return run(LocaliserNode)


if __name__ == "__main__":
    sys.exit(main())
