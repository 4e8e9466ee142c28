"""Keeps scans along the way and closes loops."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array
from scipy.sparse.csgraph import dijkstra

from tracked_localization.mapping.log_odds_grid import LogOddsSettings
from tracked_localization.matching.information import information_in, with_floor
from tracked_localization.matching.scan_matcher import Match, MatchSettings
from tracked_localization.pose_graph.graph_solver import fitted, misfit
from tracked_localization.pose_graph.key_scan import Edge, KeyScan
from tracked_localization.pose_graph.loop_finder import LoopFinder
from tracked_localization.pose_graph.settings import LoopSettings
from tracked_types import Pose2, ScanPoints, wrap_angle

Array = NDArray[np.float64]
_ALIKE_M, _ALIKE_RAD = 0.3, 0.08
_REST_SCANS = 1  # kept scans without a look after one that came back to nothing


@dataclass(frozen=True, slots=True)
class Kept:
    """What became of a scan. closed: loops were closed, all poses are new. refused: why a loop was none, or empty."""

    kept: bool
    closed: bool = False
    refused: str = ""


class LoopCloser:
    """The graph of kept scans: motions between neighbours, loops where the robot has come back.

    A loop counts when several kept scans in a row have come back to the same place, and when the poses that fit all
    edges do not contradict it; a robust weight keeps a wrong one from bending the map before it is found out.
    """

    def __init__(self, settings: LoopSettings, grid: LogOddsSettings, matching: MatchSettings) -> None:
        self._settings = settings
        self._finder = LoopFinder(settings, grid, matching)
        self.scans: list[KeyScan] = []
        self.motions: list[Edge] = []
        self.loops: list[Edge] = []
        self._waiting: list[Edge] = []
        self._rest = 0
        self.refused: dict[str, int] = {}

    def ways_m(self) -> Array:
        """Way (n,) from the last kept scan to each, by motions and closed loops, which are no way at all."""
        edges = [*self.motions, *self.loops]
        lengths = [math.hypot(edge.pose.x_m, edge.pose.y_m) for edge in self.motions] + [0.0] * len(self.loops)
        starts, ends = [edge.start for edge in edges], [edge.end for edge in edges]
        count = len(self.scans)
        graph = csr_array((np.maximum(lengths, 1e-3), (starts, ends)), shape=(count, count))
        ways: Array = dijkstra(graph, directed=False, indices=count - 1)
        return ways

    def add(self, points: ScanPoints, pose: Pose2, match: Match | None) -> Kept:
        """Take one scan placed at ``pose`` in the map; ``match`` that put it there, None for odometry alone."""
        if not self.scans:
            self.scans.append(KeyScan(points, pose))
            return Kept(kept=True)
        last = self.scans[-1]
        step = last.pose.inverse().compose(pose)
        distance, turn = math.hypot(step.x_m, step.y_m), abs(step.yaw_rad)
        if distance < self._settings.key_distance_m and turn < self._settings.key_turn_rad:
            return Kept(kept=False)
        self.scans.append(KeyScan(points, pose))
        index = len(self.scans) - 1
        self.motions.append(Edge(index - 1, index, step, self._of_motion(pose, match, distance, turn)))
        return self._look()

    def _of_motion(self, pose: Pose2, match: Match | None, distance: float, turn: float) -> Array:
        """Information of a motion: the odometry's, and the scan's along the directions it shows."""
        settings = self._settings
        drift_m = settings.odometry_m_per_m * distance + 0.01
        drift_rad = settings.odometry_rad_per_m * (distance + 0.3 * turn) + 0.002
        information: Array = np.diag([drift_m**-2, drift_m**-2, drift_rad**-2])
        if match is not None:
            seen = with_floor(match.information, settings.match_floor_m, settings.match_floor_rad)
            information = information + information_in(pose, seen)
        return information

    def _look(self) -> Kept:
        if self._rest:
            self._rest -= 1
            return Kept(kept=True)
        place = self._finder.candidate(self.scans, self.ways_m())
        if place is None:
            self._waiting.clear()
            return Kept(kept=True)
        guess = None
        if self._waiting:
            guess = self._correction(self._waiting[-1]).compose(self.scans[-1].pose)
        edge, reason = self._finder.edge(self.scans, place, guess)
        if edge is None:
            self._rest = 0 if self._waiting else _REST_SCANS
            return self._refuse(reason)
        if self._waiting and not self._agree(self._waiting[-1], edge):
            self._waiting = [edge]
            return self._refuse("neighbouring scans come back to different places")
        self._waiting.append(edge)
        if len(self._waiting) < self._settings.loop_confirmations:
            return Kept(kept=True)
        return self._close()

    def _agree(self, one: Edge, other: Edge) -> bool:
        """Whether two loops take the last kept scan to about the same place."""
        last = self.scans[-1].pose
        first, second = self._correction(one).compose(last), self._correction(other).compose(last)
        near = math.hypot(first.x_m - second.x_m, first.y_m - second.y_m) < _ALIKE_M
        return near and abs(wrap_angle(first.yaw_rad - second.yaw_rad)) < _ALIKE_RAD

    def _correction(self, edge: Edge) -> Pose2:
        """Motion of the map that takes the end of a loop to where it has come back."""
        return self.scans[edge.start].pose.compose(edge.pose).compose(self.scans[edge.end].pose.inverse())

    def _close(self) -> Kept:
        poses = [scan.pose for scan in self.scans]
        loops = [*self.loops, *self._waiting]
        found = fitted(poses, self.motions, loops)
        limit = self._settings.loop_chi_square
        if any(misfit(found, edge) > limit for edge in (*loops, *self.motions)):
            self._waiting.clear()
            return self._refuse("the loop contradicts the way driven")
        self.loops, self._waiting = loops, []
        for scan, pose in zip(self.scans, found, strict=True):
            scan.pose = pose
        return Kept(kept=True, closed=True)

    def _refuse(self, reason: str) -> Kept:
        self.refused[reason] = self.refused.get(reason, 0) + 1
        return Kept(kept=True, refused=reason)
