"""A robot in a room of straight walls: exact scans, odometry that sees too little of every turn, no physics."""

import math
from array import array
from pathlib import Path
from typing import Any

import numpy as np
from nav_msgs.msg import OccupancyGrid
from nav_msgs.msg import Odometry as OdometryMessage
from sensor_msgs.msg import LaserScan as LaserScanMessage

from node_kit import qos
from node_kit.conversions import occupancy_grid_to_message, odometry_to_message, scan_to_message
from tests.support.probe import Probe
from tracked_description import load_robot
from tracked_localization.mapping.log_odds_grid import LogOddsGrid, LogOddsSettings
from tracked_localization.mapping.map_files import save_map
from tracked_localization.matching.line_world import ROOM
from tracked_types import OccupancyMap, Odometry, PeriodGrid, Pose2, Twist2
from tracked_types.scan_points import scan_points

ROBOT = load_robot()
LIDAR = Pose2(ROBOT.lidar.xyz_m[0], ROBOT.lidar.xyz_m[1], ROBOT.lidar.rpy_rad[2])
SEEN_TURN = 0.97
ODOMETRY_GRID = PeriodGrid(ROBOT.odometry.rate_hz)
PER_SCAN = ROBOT.odometry.rate_hz // ROBOT.lidar.rate_hz


def room_map() -> OccupancyMap:
    """The room as scans from five places show it."""
    grid = LogOddsGrid(LogOddsSettings(), "map")
    for x, y in ((-3.0, 0.0), (0.0, 1.0), (0.0, -2.0), (3.0, 2.0), (4.0, -2.0)):
        base = Pose2(x, y, 0.0)
        for _ in range(4):
            grid.add(scan_points(ROOM.scan(base.compose(LIDAR)), LIDAR), base)
    return grid.as_map()


def room_map_file(folder: Path) -> Path:
    """The same, saved."""
    return save_map(room_map(), folder / "room")


class RoomRobot:
    """Publishes scan and odom of a robot that stands at ``truth`` and goes where it is told."""

    def __init__(self, probe: Probe, truth: Pose2) -> None:
        create = probe.node.create_publisher
        self._scans = create(LaserScanMessage, "scan", qos.STATE)
        self._odometry = create(OdometryMessage, "odom", qos.STATE)
        self._maps = create(OccupancyGrid, "map", qos.LATCHED)
        self._random = np.random.default_rng(0)
        self._index = 0
        self.truth = truth
        self.blind = False
        self.odom_pose = Pose2(0.0, 0.0, 0.0)

    @property
    def stamp_ns(self) -> int:
        """Its time."""
        return ODOMETRY_GRID.stamp_ns(self._index)

    @property
    def heard(self) -> bool:
        """Whether somebody subscribes to scans and odometry."""
        return bool(self._scans.get_subscription_count() and self._odometry.get_subscription_count())

    def send_map(self, changed: dict[str, Any] | None = None) -> None:
        """Publish the map, or one with other fields in its info."""
        message = occupancy_grid_to_message(room_map())
        for name, value in (changed or {}).items():
            setattr(message.info, name, value)
        self._maps.publish(message)

    def live(self, seconds: float, speed_mps: float = 0.0, yaw_rate_radps: float = 0.0) -> None:
        """Go on so long; a scan, all its beams at once, comes with every sixth odometry."""
        period_s = 1.0 / ROBOT.odometry.rate_hz
        twist = Twist2(speed_mps, SEEN_TURN * yaw_rate_radps)
        for _ in range(round(seconds * ROBOT.odometry.rate_hz)):
            self._index += 1
            self.truth = self.truth.compose(Pose2(speed_mps * period_s, 0.0, yaw_rate_radps * period_s))
            seen = Pose2(speed_mps * period_s, 0.0, SEEN_TURN * yaw_rate_radps * period_s)
            self.odom_pose = self.odom_pose.compose(seen)
            if self._index % PER_SCAN == 0:
                self.send_scan()
            odometry = Odometry(
                self.stamp_ns,
                ROBOT.frames.odom,
                ROBOT.frames.base_footprint,
                self.odom_pose,
                twist,
                np.eye(3) * 1e-4,
                np.eye(2) * 1e-4,
            )
            self._odometry.publish(odometry_to_message(odometry))

    def send_scan(self, **changed: Any) -> None:
        """Publish one scan, or one with other fields."""
        scan = ROOM.scan(self.truth.compose(LIDAR), self._random, stamp_ns=self.stamp_ns)
        message = scan_to_message(scan)
        message.header.frame_id = ROBOT.frames.lidar
        if self.blind:
            message.ranges = array("f", [math.nan] * len(message.ranges))
        for name, value in changed.items():
            setattr(message, name, value)
        self._scans.publish(message)
