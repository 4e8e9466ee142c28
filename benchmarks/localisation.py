"""Localisation on the saved map of rooms, simulated: while slipping, after a kidnap, and anywhere on the whole map.

Prints a table and writes out/localisation/metrics.json. The robot drives on ice, on ice under one track, over a step of
40 mm, and turns on the spot; its odometry follows the scans as in the graph of `navigate`. --quick takes fewer runs.
"""

import argparse
import math
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import partial
from importlib import resources
from multiprocessing import get_context
from pathlib import Path
from time import thread_time

import numpy as np
from numpy.typing import NDArray
from rooms_drive import TOUR, RoomsDrive, faces_of, slippery_rooms, start_of_seed

from sim_bridge.world import load_world
from tracked_description import Robot, load_robot
from tracked_localization.localisation.global_search import SearchSettings, find_on_map
from tracked_localization.localisation.localiser import LocaliserSettings
from tracked_localization.localisation.odometry_anchor import AnchorSettings
from tracked_localization.localisation.robot_on_map import Phase, RobotOnMap, RobotOnMapSettings
from tracked_localization.mapping.map_files import load_map
from tracked_localization.matching.scan_alignment import AlignedScan, ScanAlignment
from tracked_localization.matching.scan_matcher import MatchSettings
from tracked_localization.matching.wall_field import WallField
from tracked_report.results import write_metrics
from tracked_report.terminal import render_table
from tracked_types import OccupancyMap, Pose2, wrap_angle

SEED = 21
RIGHT_M, RIGHT_RAD = 0.1, 0.05
_ROOM_FOR_THE_ROBOT_M = 0.45
_LONGEST_S = 5.0

Array = NDArray[np.float64]


def saved_map() -> OccupancyMap:
    """The packaged map, made by the scenario `map`."""
    return load_map(Path(str(resources.files("tracked_bringup") / "data" / "maps" / "rooms.yaml")), "map")


class Follower:
    """The drive's own odometry and a localiser, each hearing the other."""

    def __init__(self, drive: RoomsDrive, occupancy_map: OccupancyMap, *, search: bool) -> None:
        self._drive = drive
        self._alignment = ScanAlignment.of_robot(drive.simulator.robot)
        settings = RobotOnMapSettings(correct_odometry=True, relocalise_when_lost=search)
        parts = (LocaliserSettings(), MatchSettings(), SearchSettings(), AnchorSettings())
        self.robot = RobotOnMap(settings, *parts)
        self.robot.set_map(occupancy_map)
        drive.filter.expect_poses()
        self.newest: AlignedScan | None = None
        self._odom_in_map: Pose2 | None = None

    def run(self, seconds: float) -> Iterator[tuple[int, Pose2 | None]]:
        """Stamp and pose on the map with every odometry; None while the robot is not localised."""
        for moment in self._drive.moments(seconds):
            for estimate in moment.estimates:
                odometry = estimate.odometry
                self._take(self._alignment.add_odometry(odometry))
                self.robot.work(odometry.stamp_ns)
                known = self.robot.phase is Phase.LOCALISED and self._odom_in_map is not None
                yield odometry.stamp_ns, self._odom_in_map.compose(odometry.pose) if known else None
            for scan in moment.batch.scans:
                self._take(self._alignment.add_scan(scan))

    def _take(self, scans: list[AlignedScan]) -> None:
        for scan in scans:
            self.newest = scan
            found = self.robot.add(scan)
            if found is None:
                continue
            self._odom_in_map = found.odom_in_map
            if found.measured is not None:
                self._drive.filter.add_pose(found.measured)


@dataclass(frozen=True, slots=True)
class SlippingRun:
    """errors: of the pose with every odometry, (n, 3). share: of the instants at which the robot was localised."""

    seed: int
    errors: Array
    share: float

    def rms(self) -> tuple[float, float]:
        """Of the distance (m) and of the heading (rad)."""
        return rms(np.hypot(self.errors[:, 0], self.errors[:, 1])), rms(self.errors[:, 2])


def rms(values: Array) -> float:
    """Root mean square."""
    return float(np.sqrt(np.mean(np.square(values))))


def slipping(seed: int, seconds: float) -> SlippingRun:
    """One drive round through hall and rooms; the robot is told where it starts."""
    drive = RoomsDrive(load_robot(), slippery_rooms(), seed, start_of_seed(seed), TOUR)
    follower = Follower(drive, saved_map(), search=True)
    follower.robot.set_pose(drive.simulator.start)
    found = list(follower.run(seconds))
    drive.close()
    began = next(index for index, (_, pose) in enumerate(found) if pose is not None)
    known = [(stamp_ns, pose.as_array()) for stamp_ns, pose in found[began:] if pose is not None]
    errors = np.array([pose for _, pose in known]) - drive.true_poses([stamp_ns for stamp_ns, _ in known])
    errors[:, 2] = np.arctan2(np.sin(errors[:, 2]), np.cos(errors[:, 2]))
    return SlippingRun(seed, errors, len(known) / (len(found) - began))


def places(robot: Robot, count: int, seed: int) -> list[Pose2]:
    """Where the robot has room to stand in the rooms, headed anywhere."""
    faces, generator, found = faces_of(load_world("rooms"), robot), np.random.default_rng([seed, 0x706C]), []
    while len(found) < count:
        x, y, yaw = generator.uniform([0.4, 0.4, -math.pi], [7.6, 5.6, math.pi]).tolist()
        inside_something = 6.2 < x < 7.4 and 5.3 < y < 5.9
        if faces.distances(np.array([[x, y]]))[0] > _ROOM_FOR_THE_ROBOT_M and not inside_something:
            found.append(Pose2(x, y, yaw))
    return found


def is_right(found: Pose2, truth: Pose2) -> bool:
    """Near enough for scans to be followed from there, and not another place."""
    near = math.hypot(found.x_m - truth.x_m, found.y_m - truth.y_m) < RIGHT_M
    return near and abs(wrap_angle(found.yaw_rad - truth.yaw_rad)) < RIGHT_RAD


def noticed_after_s(place: Pose2, seed: int) -> float:
    """The localised robot is lifted to ``place``; time until it says that it is lost, or knows that it is there."""
    drive = RoomsDrive(load_robot(), load_world("rooms"), seed, load_world("rooms").start(), [])
    follower = Follower(drive, saved_map(), search=False)
    follower.robot.set_pose(drive.simulator.start)
    for _, pose in follower.run(_LONGEST_S):
        if pose is not None:
            break
    drive.simulator.place_robot(place)
    lifted_ns = drive.simulator.stamp_ns
    for stamp_ns, pose in follower.run(_LONGEST_S):
        if stamp_ns > lifted_ns and (pose is None or is_right(pose, drive.truth[-1].pose)):
            drive.close()
            return (stamp_ns - lifted_ns) * 1e-9
    drive.close()
    return _LONGEST_S


def searched(everywhere: list[Pose2], seed: int) -> tuple[int, int, list[float]]:
    """Right answers, ambiguous answers, and processor time (s) of every search of the whole map."""
    occupancy_map = saved_map()
    field, settings, matching = WallField(occupancy_map), SearchSettings(), MatchSettings()
    right, ambiguous, seconds = 0, 0, []
    drive = RoomsDrive(load_robot(), load_world("rooms"), seed, everywhere[0], [])
    follower = Follower(drive, occupancy_map, search=False)
    for place in everywhere:
        drive.simulator.place_robot(place)
        for _ in follower.run(0.5):
            pass
        scan = follower.newest
        assert scan is not None
        begun = thread_time()
        found = find_on_map(occupancy_map, field, scan.points, settings, matching)
        seconds.append(thread_time() - begun)
        truth = Pose2(*drive.true_poses([scan.points.stamp_ns])[0].tolist())
        ambiguous += len(found) > 1
        right += len(found) == 1 and is_right(found[0].pose, truth)
    drive.close()
    return right, ambiguous, seconds


def main() -> None:
    """Measure, print, write out/localisation/metrics.json."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--quick", action="store_true", help="two drives, four kidnaps, ten searches")
    quick = parser.parse_args().quick
    seeds = range(SEED, SEED + (2 if quick else 30))
    lifts, searches = (4, 10) if quick else (30, 100)
    robot = load_robot()
    with ProcessPoolExecutor(2, mp_context=get_context("spawn")) as pool:
        runs = list(pool.map(partial(slipping, seconds=40.0 if quick else 120.0), seeds))
        noticed = list(pool.map(noticed_after_s, places(robot, lifts, SEED), range(SEED, SEED + lifts)))
    right, ambiguous, seconds = searched(places(robot, searches, SEED + 1), SEED)
    everything = np.concatenate([run.errors for run in runs])
    worst = [max(values) for values in zip(*(run.rms() for run in runs), strict=True)]
    values = {
        "slipping.runs": float(len(runs)),
        "slipping.position_rms_m": rms(np.hypot(everything[:, 0], everything[:, 1])),
        "slipping.heading_rms_rad": rms(everything[:, 2]),
        "slipping.worst_run_position_rms_m": worst[0],
        "slipping.worst_run_heading_rms_rad": worst[1],
        "slipping.largest_position_m": float(np.hypot(everything[:, 0], everything[:, 1]).max()),
        "slipping.largest_heading_rad": float(np.abs(everything[:, 2]).max()),
        "slipping.localised_share": min(run.share for run in runs),
        "kidnap.noticed_slowest_s": max(noticed),
        "kidnap.noticed_median_s": float(np.median(noticed)),
        "search.right_share": right / searches,
        "search.ambiguous_share": ambiguous / searches,
        "search.slowest_s": max(seconds),
        "search.median_s": float(np.median(seconds)),
    }
    rows = [[name, f"{value:.4g}"] for name, value in values.items()]
    print(render_table(rows, ["localisation in rooms", "measured"], ["left", "right"]))
    if quick:
        print("quick: parts of two drives instead of thirty whole ones, fewer kidnaps and searches")
    write_metrics("localisation", {f"localisation.{key}": value for key, value in values.items()}, seed=SEED)


if __name__ == "__main__":
    main()
