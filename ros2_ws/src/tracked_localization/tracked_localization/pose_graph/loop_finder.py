"""Places that the robot comes back to: near by, long ago, and with walls that agree."""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from tracked_localization.mapping.log_odds_grid import LogOddsGrid, LogOddsSettings
from tracked_localization.matching.information import information_in, with_floor
from tracked_localization.matching.scan_matcher import Match, MatchSettings, match_scan
from tracked_localization.matching.wall_field import WallField
from tracked_localization.pose_graph.key_scan import Edge, KeyScan
from tracked_localization.pose_graph.settings import LoopSettings
from tracked_types import Pose2

Array = NDArray[np.float64]
_NEIGHBOURS = 5  # kept scans on either side that make up a place
_RANGE_M = 12.0
_RADII_M = (0.0, 0.4, 0.8, 1.2, 1.6, 2.0)
_SPACING_M = 0.45
_COARSE_POINTS, _COARSE_M, _FINE_STARTS, _HOPELESS = 60, 0.2, 8, 0.5
_TURNS_RAD = (0.0, 0.15, -0.15)


class LoopFinder:
    """Lays a kept scan over the places around it."""

    def __init__(self, settings: LoopSettings, grid: LogOddsSettings, matching: MatchSettings) -> None:
        self._settings, self._grid, self._matching = settings, grid, matching

    def candidate(self, scans: Sequence[KeyScan], ways_m: Array) -> int | None:
        """The nearest place that the last of ``scans`` may have come back to; ``ways_m`` (n,) from it to each."""
        settings = self._settings
        places = np.array([(scan.pose.x_m, scan.pose.y_m) for scan in scans])
        distance = np.hypot(*(places - places[-1]).T)
        reach = settings.loop_radius_m + settings.loop_share_m_per_m * ways_m
        distance[(distance > reach) | (ways_m < settings.loop_least_way_m)] = np.inf
        nearest = int(np.argmin(distance))
        return nearest if np.isfinite(distance[nearest]) else None

    def edge(self, scans: Sequence[KeyScan], place: int, guess: Pose2 | None = None) -> tuple[Edge | None, str]:
        """Where the last of ``scans`` is, seen from the kept scan ``place``, or why that cannot be said.

        guess: of the last scan's pose in the map, if another scan has come back to this place before.
        """
        last, around = scans[-1], scans[max(0, place - _NEIGHBOURS) : place + _NEIGHBOURS + 1]
        grid = LogOddsGrid(self._grid, "place")
        for scan in around:
            grid.add(scan.points, scan.pose)
        try:
            field = WallField(grid.as_map(last.pose, _RANGE_M + self._settings.loop_radius_m))
        except ValueError:
            return None, "nothing was seen there"
        near = last.points.hits[np.hypot(last.points.hits[:, 0], last.points.hits[:, 1]) < _RANGE_M]
        settings = self._settings
        starts = _promising(field, near, _starts(last.pose, settings.loop_radius_m)) if guess is None else [guess]
        matches = [match_scan(field, near, start, self._matching) for start in starts]
        good = [match for match in matches if not self._doubt(match)]
        if not good:
            return None, self._doubt(max(matches, key=lambda match: match.agreement))
        best = max(good, key=lambda match: match.agreement)
        rivals = [match for match in good if _apart(match.pose, best.pose) and match.agreement > 0.95 * best.agreement]
        if rivals:
            return None, "the scan fits that place in more than one way"
        frame = scans[place].pose
        information = with_floor(best.information, settings.loop_floor_m, settings.loop_floor_rad)
        relative = frame.inverse().compose(best.pose)
        return Edge(place, len(scans) - 1, relative, information_in(best.pose, information)), ""

    def _doubt(self, match: Match) -> str:
        settings = self._settings
        if match.seen < 3:
            return "the scan does not show where along the walls it is"
        if match.agreement < settings.loop_agreement:
            return f"only {match.agreement:.0%} of the scan lies on the walls of that place"
        if match.deviation_m > settings.loop_deviation_m:
            return f"the scan lies {match.deviation_m:.2f} m off the walls of that place"
        return ""


def _promising(field: WallField, points: Array, starts: list[Pose2]) -> list[Pose2]:
    """The starts from which most of the points are near a wall already."""
    few = points[:: max(1, len(points) // _COARSE_POINTS)]
    if not len(few):
        return starts[:1]
    placed = np.concatenate([start.transform(few) for start in starts])
    near = (field.at(placed).distance_m < _COARSE_M).reshape(len(starts), len(few)).mean(axis=1)
    if near.max() < _HOPELESS:
        return starts[:1]
    return [starts[index] for index in np.argsort(-near, kind="stable")[:_FINE_STARTS]]


def _starts(pose: Pose2, reach_m: float) -> list[Pose2]:
    """Guesses around a pose: the farther the way, the less it is known."""
    starts = []
    for radius in (radius for radius in _RADII_M if radius <= reach_m):
        count = max(1, math.ceil(2.0 * math.pi * radius / _SPACING_M))
        for step in range(count):
            angle = 2.0 * math.pi * step / count
            for turn in _TURNS_RAD:
                starts.append(
                    Pose2(pose.x_m + radius * math.cos(angle), pose.y_m + radius * math.sin(angle), pose.yaw_rad + turn)
                )
    return starts


def _apart(one: Pose2, other: Pose2) -> bool:
    off = one.inverse().compose(other)
    return math.hypot(off.x_m, off.y_m) > 0.25 or abs(off.yaw_rad) > 0.1
