"""Real scans: a loop of 76 m indoors, mapped with jumpy odometry.

Prints a table, writes out/indoor_loop/metrics.json and pictures of the maps: by odometry alone, and with loops closed.
"""

import argparse
from pathlib import Path
from time import thread_time

import cv2
import numpy as np

from tracked_lab.recordings.indoor_loop import IndoorLoop, load_indoor_loop, overlap_residual_m
from tracked_localization.mapping.log_odds_grid import LogOddsGrid, LogOddsSettings
from tracked_localization.mapping.mapper import Mapper, MapperSettings
from tracked_localization.matching.scan_matcher import MatchSettings
from tracked_localization.pose_graph.graph_solver import load_solver
from tracked_localization.pose_graph.loop_closing_mapper import LoopClosingMapper
from tracked_report.results import output_folder, write_metrics
from tracked_report.terminal import render_table
from tracked_types import OccupancyMap, Pose2

SEED = 0  # nothing is drawn


def with_loops(loop: IndoorLoop) -> tuple[LoopClosingMapper, list[Pose2]]:
    """The mapper, and the pose of every scan as known at the end."""
    mapper = LoopClosingMapper(MapperSettings(), LogOddsSettings(), MatchSettings())
    placed = [mapper.add(points, pose).pose for points, pose in zip(loop.points, loop.odometry, strict=True)]
    final = {scan.points.stamp_ns: scan.pose for scan in mapper.closer.scans}
    poses, moved = [], Pose2(0.0, 0.0, 0.0)
    for points, pose in zip(loop.points, placed, strict=True):
        if points.stamp_ns in final:
            moved = final[points.stamp_ns].compose(pose.inverse())
        poses.append(moved.compose(pose))
    return mapper, poses


def picture(occupancy_map: OccupancyMap, path: Path) -> None:
    """Dark is occupied, light is free, grey is unknown."""
    percent = occupancy_map.occupancy.astype(np.int32)
    grey = np.where(percent < 0, 200, 255 - percent * 255 // 100).astype(np.uint8)
    cv2.imwrite(str(path), grey[::-1])


def main() -> None:
    """Measure, print, write out/indoor_loop/metrics.json."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--quick", action="store_true", help="the same: everything is measured in seconds")
    parser.parse_args()
    load_solver()
    loop = load_indoor_loop()
    odometry = LogOddsGrid(LogOddsSettings(), "map")
    for points, pose in zip(loop.points, loop.odometry, strict=True):
        odometry.add(points, pose)
    plain = Mapper(MapperSettings(), LogOddsSettings(), MatchSettings())
    begin = thread_time()
    poses = [plain.add(points, pose).pose for points, pose in zip(loop.points, loop.odometry, strict=True)]
    middle = thread_time()
    mapper, closed = with_loops(loop)
    end = thread_time()
    figures = {
        "odometry.residual_m": overlap_residual_m(loop.points, loop.odometry),
        "plain.residual_m": overlap_residual_m(loop.points, poses),
        "plain.speed": loop.duration_s / (middle - begin),
        "loops.residual_m": overlap_residual_m(loop.points, closed),
        "loops.speed": loop.duration_s / (end - middle),
        "loops.edges": float(len(mapper.closer.loops)),
        "loops.refused": float(sum(mapper.closer.refused.values())),
    }
    rows = [[name, f"{value:.4g}"] for name, value in figures.items()]
    print(render_table(rows, ["indoor loop, real scans", "measured"], ["left", "right"]))
    print(write_metrics("indoor_loop", {f"indoor_loop.{key}": value for key, value in figures.items()}, seed=SEED))
    folder = output_folder() / "indoor_loop"
    for name, drawn in (("odometry", odometry.as_map()), ("plain", plain.as_map()), ("loops", mapper.as_map())):
        picture(drawn, folder / f"{name}.png")
        print(folder / f"{name}.png")


if __name__ == "__main__":
    main()
