"""A way over grid cells made into one that a robot would drive: corners cut where that costs nothing, then rounded."""

import itertools

import numpy as np
from numpy.typing import NDArray

from tracked_navigation.planning.costmap import CostMap
from tracked_types import Pose2

Array = NDArray[np.float64]
_SLACK = 1.001


def smooth_path(costmap: CostMap, points: Array, goal: Pose2, *, spacing_m: float = 0.05, rounds: int = 40) -> Array:
    """Poses (m, 3): x, y (m) and heading (rad), from the first of ``points`` (n, 2) to ``goal``.

    No piece of the result costs more than the piece of the way it replaces, and none leads where the robot must not be.
    Headings point along the path; the last one is the goal's.
    """
    kept = _shortcut(costmap, points)
    dense = _resampled(kept, spacing_m)
    rounded = _rounded(costmap, dense, rounds)
    along = np.diff(rounded, axis=0)
    headings = np.arctan2(along[:, 1], along[:, 0]) if len(along) else np.zeros(0)
    return np.column_stack([rounded, np.append(headings, goal.yaw_rad)])


def line_cost(costmap: CostMap, begin: Array, end: Array) -> float:
    """Metres times cost along a straight line (its ends included), inf if it leads where the robot must not be."""
    length = float(np.hypot(*(end - begin)))
    count = max(2, int(np.ceil(2.0 * length / costmap.map.resolution_m)) + 1)
    shares = np.linspace(0.0, 1.0, count)[:, None]
    return length * float(costmap.at(begin + shares * (end - begin)).mean())


def _shortcut(costmap: CostMap, points: Array) -> Array:
    """Leave out what lies between two points of the way wherever the straight line is no dearer."""
    pieces = [line_cost(costmap, begin, end) for begin, end in itertools.pairwise(points)]
    spent = np.concatenate([[0.0], np.cumsum(pieces)])
    kept, here = [0], 0
    while here < len(points) - 1:
        step, there = 1, here + 1
        while here + 2 * step < len(points):  # twice as far each time, then back by halves
            step *= 2
            if line_cost(costmap, points[here], points[here + step]) > _SLACK * (spent[here + step] - spent[here]):
                break
            there = here + step
        while step > 1:
            step //= 2
            trial = there + step
            if trial < len(points) and line_cost(costmap, points[here], points[trial]) <= _SLACK * (
                spent[trial] - spent[here]
            ):
                there = trial
        kept.append(there)
        here = there
    return points[kept]


def _resampled(points: Array, spacing_m: float) -> Array:
    """Points (m, 2) at equal distances of about the spacing, both ends kept."""
    lengths = np.hypot(*np.diff(points, axis=0).T)
    travelled = np.concatenate([[0.0], np.cumsum(lengths)])
    count = max(2, int(np.ceil(travelled[-1] / spacing_m)) + 1)
    wanted = np.linspace(0.0, travelled[-1], count)
    return np.column_stack([np.interp(wanted, travelled, points[:, axis]) for axis in range(2)])


def _rounded(costmap: CostMap, points: Array, rounds: int) -> Array:
    """Each point moves towards the middle of its neighbours unless that place is dearer than the dearest around."""
    path = points.copy()
    for _ in range(rounds):
        middle = 0.25 * (path[:-2] + path[2:]) + 0.5 * path[1:-1]
        cost = costmap.at(path)
        allowed = np.maximum(np.maximum(cost[:-2], cost[2:]), cost[1:-1])
        better = np.isfinite(costmap.at(middle)) & (costmap.at(middle) <= allowed)
        path[1:-1] = np.where(better[:, None], middle, path[1:-1])
    return path
