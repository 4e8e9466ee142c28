"""A loop indoors with a laser scanner and jumpy odometry; nobody recorded where the robot really was."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tracked_lab.recordings.recording_file import load_arrays
from tracked_localization.mapping.log_odds_grid import LogOddsGrid, LogOddsSettings
from tracked_localization.matching.wall_field import WallField
from tracked_types import LaserScan, Pose2, ScanPoints
from tracked_types.scan_points import scan_points

Array = NDArray[np.float64]
_FIELDS = ("scan_t", "ranges_mm", "angle_min", "angle_increment", "scan_odom", "laser_in_base_xyyaw")
_RANGE_MAX_M = 30.0
_BEGIN_M, _END_M, _NEAR_M, _RANGE_M = 15.0, 25.0, 3.0, 8.0


@dataclass(frozen=True, slots=True)
class IndoorLoop:
    """Points of each scan in the frame of the base, and the pose that odometry gave it."""

    points: list[ScanPoints]
    odometry: list[Pose2]
    duration_s: float


def load_indoor_loop() -> IndoorLoop:
    """The packaged recording.

    Raises
    ------
    RecordingError: if it cannot be used.
    """
    arrays = load_arrays("sena_telecom", _FIELDS)
    lidar = Pose2(*arrays["laser_in_base_xyyaw"].tolist())
    points = []
    for time_s, millimetres in zip(arrays["scan_t"], arrays["ranges_mm"], strict=True):
        ranges = np.where(millimetres == 0.0, np.nan, 1e-3 * millimetres).astype(np.float32)
        start, increment = float(arrays["angle_min"]), float(arrays["angle_increment"])
        scan = LaserScan(round(time_s * 1e9), "laser", start, increment, 0.0, 0.0, 0.05, _RANGE_MAX_M, ranges)
        points.append(scan_points(scan, lidar))
    odometry = [Pose2(*pose.tolist()) for pose in arrays["scan_odom"]]
    return IndoorLoop(points, odometry, float(arrays["scan_t"][-1]))


def overlap_residual_m(points: list[ScanPoints], poses: list[Pose2]) -> float:
    """Median distance (m) of the last scans' points from the walls of the first ones, where the loop closes.

    The walls are drawn from the first 15 m of the way alone. Of the last 25 m every scan counts that was taken within
    3 m of them, with its points up to 8 m; a point farther than 1 m from any wall of theirs saw something else.

    Raises
    ------
    ValueError: if the end does not come near the beginning.
    """
    places = np.array([(pose.x_m, pose.y_m) for pose in poses])
    way = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(places, axis=0).T))])
    first = way < _BEGIN_M
    grid = LogOddsGrid(LogOddsSettings(), "map")
    for index in np.flatnonzero(first):
        grid.add(points[index], poses[index])
    field, distances = WallField(grid.as_map()), []
    for index in np.flatnonzero(way > way[-1] - _END_M):
        if np.hypot(*(places[first] - places[index]).T).min() > _NEAR_M:
            continue
        hits = points[index].hits
        walls = field.at(poses[index].transform(hits[np.hypot(*hits.T) < _RANGE_M]))
        distances.append(walls.distance_m[walls.distance_m < 1.0])
    if not distances:
        raise ValueError("the end of the way does not come near its beginning")
    return float(np.median(np.concatenate(distances)))
