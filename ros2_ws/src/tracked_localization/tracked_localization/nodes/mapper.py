"""Node mapper: a map of an unknown place while driving through it."""

import sys
from pathlib import Path
from typing import Any

from nav_msgs.msg import OccupancyGrid
from nav_msgs.msg import Odometry as OdometryMessage
from sensor_msgs.msg import LaserScan as LaserScanMessage
from std_srvs.srv import Trigger

from node_kit import Level, Parameter, ParameterTable, RejectedMessage, StackNode, qos, run
from node_kit.conversions import occupancy_grid_to_message, odometry_from_message, scan_from_message
from tracked_description import ROBOT_FILE, load_robot
from tracked_localization.mapping.log_odds_grid import LogOddsSettings, MapTooLargeError
from tracked_localization.mapping.map_files import MapFileError, save_map
from tracked_localization.mapping.mapper import Mapper, MapperSettings
from tracked_localization.matching.scan_alignment import AlignedScan, ScanAlignment, ScanRefused
from tracked_localization.matching.scan_matcher import MatchSettings
from tracked_localization.nodes.map_frame import INITIAL_POSE, MAP_FRAME, TOLERANCE, MapToOdom, pose_of
from tracked_types import LaserScan, Odometry, clock_set_back, to_nanoseconds

SAVE_TO = Parameter(
    "save_to", "", "path without ending that the map is saved to, at `save_map` and at the end; empty: not at all"
)
MAP_PERIOD = Parameter("map_period_s", 2.0, "stamps between two maps that are published", unit="s", low=0.1, high=600.0)
SETTINGS = (MapperSettings, LogOddsSettings, MatchSettings)
PARAMETERS = ParameterTable.from_settings(
    *SETTINGS,
    extra=(SAVE_TO, MAP_PERIOD, INITIAL_POSE, MAP_FRAME, TOLERANCE, qos.RELIABLE_SENSORS, Parameter(*ROBOT_FILE)),
)


class MapperNode(StackNode):
    """Subscribes scan, odom; publishes map, latched, and the transform map -> odom.

    Serves save_map, which writes PGM and YAML; at its end the map is saved too.
    """

    NAME = "mapper"
    PARAMETERS = PARAMETERS

    def __init__(self) -> None:
        super().__init__()
        robot = load_robot(self.value("robot_file"))
        odom_frame, map_frame = self.frame(robot.frames.odom), self.frame(self.value(MAP_FRAME.name))
        settings, grid, matching = (kind(**self.tuning(kind)) for kind in SETTINGS)
        self.mapper = Mapper(settings, grid, matching, map_frame, pose_of(self.value(INITIAL_POSE.name)))
        self.alignment = ScanAlignment.of_robot(robot)
        self.maps = self.publish_typed(OccupancyGrid, "map", occupancy_grid_to_message, qos.LATCHED)
        self.map_to_odom = MapToOdom(self, odom_frame)
        sensor = qos.sensor(reliable=self.value(qos.RELIABLE_SENSORS.name))
        lidar_frame = self.frame(robot.frames.lidar)
        self.subscribe_typed(
            LaserScanMessage, "scan", scan_from_message, self.on_scan, sensor, expected_frame=lidar_frame
        )
        self.subscribe_typed(
            OdometryMessage, "odom", odometry_from_message, self.on_odometry, qos.STATE, expected_frame=odom_frame
        )
        self.serve(Trigger, "save_map", self.on_save)
        self._period_ns = to_nanoseconds(self.value(MAP_PERIOD.name))
        self._published_ns: int | None = None
        self._scans = 0
        self.diagnostics.report("mapping", Level.WARN, "no scan yet")

    def on_odometry(self, odometry: Odometry) -> None:
        """One odometry in; the scans that waited for it are mapped."""
        self._take(self.alignment.add_odometry(odometry))

    def on_scan(self, scan: LaserScan) -> None:
        """One scan in."""
        try:
            self._take(self.alignment.add_scan(scan))
        except ScanRefused as refusal:
            raise RejectedMessage(str(refusal)) from refusal

    def on_save(self, _request: Any, response: Any) -> Any:
        """Save the map where the parameter says."""
        response.success, response.message = self._save()
        return response

    def safe_stop(self) -> None:
        """Save the map before everything goes."""
        if self.value(SAVE_TO.name):
            saved, sentence = self._save()
            if saved:
                self.get_logger().info(sentence)
            else:
                self.get_logger().error(sentence)

    def _take(self, scans: list[AlignedScan]) -> None:
        for scan in scans:
            try:
                placed = self.mapper.add(scan.points, scan.odom_pose)
            except MapTooLargeError as error:
                self.diagnostics.report("mapping", Level.WARN, f"a scan is left out: {error}")
                continue
            self._scans += 1
            stamp_ns = scan.points.stamp_ns
            assert self.mapper.odom_in_map is not None
            self.map_to_odom.send(self.mapper.odom_in_map, stamp_ns)
            doubt = f", the last as odometry says: {placed.reason}" if placed.reason else ""
            level = Level.WARN if placed.reason and self._scans > 1 else Level.OK
            values = {"scans": self._scans, "scans without odometry": self.alignment.uncovered}
            self.diagnostics.report("mapping", level, f"scans are added{doubt}", values)
            self._publish(stamp_ns)

    def _publish(self, stamp_ns: int) -> None:
        last_ns = self._published_ns
        if last_ns is None or clock_set_back(last_ns, stamp_ns) or stamp_ns - last_ns >= self._period_ns:
            self.maps.publish(self.mapper.as_map(), stamp_ns)
            self._published_ns = stamp_ns

    def _save(self) -> tuple[bool, str]:
        """Whether the map is saved, and a sentence about it."""
        stem = self.value(SAVE_TO.name)
        if not stem:
            return False, "parameter save_to is empty: nowhere to save the map to"
        if not self._scans:
            return False, f"there is no map to save to {stem}: no scan has come yet"
        path = Path(stem).with_suffix("") if stem.endswith((".yaml", ".pgm")) else Path(stem)
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            return True, f"map saved: {save_map(self.mapper.as_map().known_part(), path)}"
        except (MapFileError, OSError) as error:
            return False, f"map not saved: {error}"


def main() -> int:
    """Run the node; the exit code of the process."""
    return run(MapperNode)


if __name__ == "__main__":
    sys.exit(main())
