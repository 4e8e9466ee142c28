"""The map of rooms that the mapper makes while slipping, against the world as it is; simulated.

Three rounds over ice and a step, then somebody walking to and fro in the hall. Prints a table and writes
out/mapping/metrics.json. --quick drives part of one round.
"""

import argparse
import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from time import thread_time

import cv2
import numpy as np
from numpy.typing import NDArray
from rooms_drive import TOUR, Point, RoomsDrive, faces_of, slippery_rooms

from sim_bridge.walkers import Walker
from sim_bridge.world import World, load_world
from tracked_description import Robot, load_robot
from tracked_localization.mapping.log_odds_grid import LogOddsGrid, LogOddsSettings
from tracked_localization.mapping.mapper import Mapper, MapperSettings
from tracked_localization.matching.line_world import LineWorld
from tracked_localization.matching.scan_alignment import AlignedScan, ScanAlignment
from tracked_localization.matching.scan_matcher import MatchSettings
from tracked_report.results import write_metrics
from tracked_report.terminal import render_table
from tracked_types import OccupancyMap, Pose2

SEED = 31
CELL_M = LogOddsSettings().resolution_m
HALF_A_CELL_OFF = LogOddsSettings(grid_shift_m=CELL_M / 2.0)
_LEAST_DOUBLED = 3  # connected cells off every wall that count as a wall of their own
_WALKER_ROOM_M = 0.4
_AROUND_THE_HALL: tuple[Point, ...] = ((2.0, 0.8), (1.6, 1.7), (1.2, 1.2))

Array = NDArray[np.float64]


@dataclass(slots=True)
class Mapped:
    """A drive with its mappers. add_s: processor time (s) of every scan's match, renewal and update together."""

    mappers: list[Mapper]
    truth: list[Pose2] = field(default_factory=list)
    placed: list[Pose2] = field(default_factory=list)
    add_s: list[float] = field(default_factory=list)
    scans: list[AlignedScan] = field(default_factory=list)

    def errors_m(self) -> Array:
        """Where the first mapper put each scan against where it was taken, (n,)."""
        pairs = zip(self.truth, self.placed, strict=True)
        return np.array([math.hypot(placed.x_m - true.x_m, placed.y_m - true.y_m) for true, placed in pairs])


def drive_round(
    robot: Robot, world: World, points: Sequence[Point], seconds: float, grids: list[LogOddsSettings]
) -> Mapped:
    """Map while driving past ``points`` by a map-free odometry; one mapper for each of ``grids``."""
    drive = RoomsDrive(robot, world, SEED, world.start(), points)
    alignment = ScanAlignment.of_robot(robot)
    made = Mapped([Mapper(MapperSettings(), grid, MatchSettings(), start=world.start()) for grid in grids])
    for moment in drive.moments(seconds):
        scans = [scan for each in moment.estimates for scan in alignment.add_odometry(each.odometry)]
        scans += [found for scan in moment.batch.scans for found in alignment.add_scan(scan)]
        for scan in scans:
            begun = thread_time()
            made.placed.append(made.mappers[0].add(scan.points, scan.odom_pose).pose)
            made.add_s.append(thread_time() - begun)
            made.scans.append(scan)
            for other in made.mappers[1:]:
                other.add(scan.points, scan.odom_pose)
    poses = drive.true_poses([scan.points.stamp_ns for scan in made.scans])
    made.truth = [Pose2(*pose) for pose in poses.tolist()]
    drive.close()
    return made


def share_near(occupancy_map: OccupancyMap, faces: LineWorld) -> float:
    """Share of the occupied cells whose middle is at most one cell from a face."""
    cells = occupancy_map.centres_of(np.argwhere(occupancy_map.occupied))
    return float((faces.distances(cells) <= CELL_M).mean())


def walls_doubled(occupancy_map: OccupancyMap, faces: LineWorld) -> int:
    """Groups of three or more connected occupied cells that are farther than one and a half cells from every face."""
    cells = np.argwhere(occupancy_map.occupied)
    off = cells[faces.distances(occupancy_map.centres_of(cells)) > 1.5 * CELL_M]
    marked = np.zeros(occupancy_map.occupancy.shape, np.uint8)
    marked[off[:, 0], off[:, 1]] = 1
    _, _, statistics, _ = cv2.connectedComponentsWithStats(marked, connectivity=8)
    return int((statistics[1:, cv2.CC_STAT_AREA] >= _LEAST_DOUBLED).sum())


def update_s(scans: list[AlignedScan], poses: list[Pose2]) -> list[float]:
    """Processor time (s) of adding each scan to a grid, the one-time growth of an empty one left out."""
    grid, seconds = LogOddsGrid(HALF_A_CELL_OFF, "map"), []
    for scan, pose in zip(scans, poses, strict=True):
        begun = thread_time()
        grid.add(scan.points, pose)
        seconds.append(thread_time() - begun)
    return seconds[1:]


def marks_left(robot: Robot, seconds: float) -> tuple[int, int]:
    """Occupied cells off every face and away from where the walker is at the end, and cells that it ever crossed."""
    walker = Walker(name="visitor", waypoints_m=((3.2, 0.5), (3.2, 2.5)), speed_mps=0.45)
    world = load_world("rooms").model_copy(update={"walkers": (walker,)})
    made = drive_round(robot, world, _AROUND_THE_HALL, seconds, [HALF_A_CELL_OFF])
    rest = RoomsDrive(robot, world, SEED, made.truth[-1], [])  # stands and looks
    alignment, mapper, last_ns = ScanAlignment.of_robot(robot), made.mappers[0], 0
    assert mapper.odom_in_map is not None
    mapper.odom_in_map = made.placed[-1]  # this drive's odometry begins here
    crossed: set[tuple[int, int]] = set()
    for moment in rest.moments(seconds):
        scans = [scan for each in moment.estimates for scan in alignment.add_odometry(each.odometry)]
        scans += [found for scan in moment.batch.scans for found in alignment.add_scan(scan)]
        for scan in scans:
            mapper.add(scan.points, scan.odom_pose)
            last_ns = scan.points.stamp_ns
            x, y = walker.place_m(last_ns * 1e-9)
            crossed.add((math.floor(x / CELL_M), math.floor(y / CELL_M)))
    rest.close()
    occupancy_map = mapper.as_map()
    cells = occupancy_map.centres_of(np.argwhere(occupancy_map.occupied))
    away = np.hypot(*(cells - np.array(walker.place_m(last_ns * 1e-9))).T) > _WALKER_ROOM_M
    off = faces_of(world, robot).distances(cells) > 1.5 * CELL_M
    return int((away & off).sum()), len(crossed)


def main() -> None:
    """Measure, print, write out/mapping/metrics.json."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--quick", action="store_true", help="thirty seconds of one round")
    quick = parser.parse_args().quick
    robot, world = load_robot(), slippery_rooms()
    faces = faces_of(world, robot)
    made = drive_round(
        robot, world, TOUR if quick else TOUR * 3, 30.0 if quick else 400.0, [HALF_A_CELL_OFF, LogOddsSettings()]
    )
    shifted, plain = (mapper.as_map() for mapper in made.mappers)
    update, added = np.array(update_s(made.scans, made.placed)), np.array(made.add_s)
    marks, crossed = marks_left(robot, 10.0 if quick else 25.0)
    values = {
        "scans": float(len(made.scans)),
        "near_share": share_near(shifted, faces),
        "near_share_walls_on_borders": share_near(plain, faces),
        "walls_doubled": float(walls_doubled(shifted, faces)),
        "walls_doubled_walls_on_borders": float(walls_doubled(plain, faces)),
        "placed_rms_m": float(np.sqrt(np.mean(made.errors_m() ** 2))),
        "placed_largest_m": float(made.errors_m().max()),
        "update_median_ms": 1e3 * float(np.median(update)),
        "update_p99_ms": 1e3 * float(np.percentile(update, 99)),
        "scan_median_ms": 1e3 * float(np.median(added)),
        "scan_p99_ms": 1e3 * float(np.percentile(added, 99)),
        "marks_left": float(marks),
        "cells_crossed_by_walker": float(crossed),
    }
    rows = [[name, f"{value:.4g}"] for name, value in values.items()]
    print(render_table(rows, ["map of rooms", "measured"], ["left", "right"]))
    if quick:
        print("quick: part of one round instead of three whole ones")
    write_metrics("mapping", {f"mapping.{key}": value for key, value in values.items()}, seed=SEED)


if __name__ == "__main__":
    main()
