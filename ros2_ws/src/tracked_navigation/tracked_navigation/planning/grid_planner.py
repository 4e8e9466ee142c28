"""The cheapest way over a costmap: Dijkstra's algorithm on the 8-connected grid, by SciPy."""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array
from scipy.sparse.csgraph import dijkstra

from tracked_navigation.planning.costmap import CostMap
from tracked_types import Pose2

Array = NDArray[np.float64]
_NEIGHBOURS = ((-1, -1), (-1, 0), (-1, 1), (0, -1), (0, 1), (1, -1), (1, 0), (1, 1))
_NO_CELL = -9999  # SciPy's word for "no predecessor"


@dataclass(frozen=True, slots=True)
class GridPlan:
    """Answer to one request.

    points: cell centres (n, 2) from start to goal in the map's frame, the ends exact; None if there is no way, then
    ``reason`` says why, and ``nearest`` is the reachable place nearest to the goal, if there is any. cost: of the way
    over the grid, metres times cost.
    """

    points: Array | None
    cost: float
    reason: str = ""
    nearest: tuple[float, float] | None = None


class GridPlanner:
    """Plans on maps of one shape; weights of the grid's edges are renewed only where costs have changed.

    An edge costs its length times the mean cost of the two cells, so the result is the optimum of that graph.
    """

    def __init__(self) -> None:
        self._costmap: CostMap | None = None
        self._padded = np.zeros((0, 0))
        self._weights = np.zeros((0, 0, 0))
        self._columns = np.zeros(0, np.int32)
        self._rows = np.zeros(0, np.int32)

    def set_costmap(self, costmap: CostMap) -> None:
        """Plan on this costmap from now on."""
        height, width = costmap.cost.shape
        if self._weights.shape[:2] != (height, width):
            self._build(height, width)
            changed = (0, height, 0, width)
        else:
            different = self._padded[1:-1, 1:-1] != costmap.cost
            if not different.any():
                self._costmap = costmap
                return
            rows, columns = np.flatnonzero(different.any(axis=1)), np.flatnonzero(different.any(axis=0))
            changed = (rows[0] - 1, rows[-1] + 2, columns[0] - 1, columns[-1] + 2)
        self._padded[1:-1, 1:-1] = costmap.cost
        self._reweigh(max(changed[0], 0), min(changed[1], height), max(changed[2], 0), min(changed[3], width))
        self._costmap = costmap

    def plan(self, start: Pose2, goal: Pose2) -> GridPlan:
        """The cheapest way from ``start`` to ``goal``, both in the map's frame.

        A start too near to an obstacle leaves it by the shortest way first.

        Raises
        ------
        RuntimeError: if there is no costmap yet.
        ValueError: if start or goal are not finite.
        """
        costmap = self._costmap
        if costmap is None:
            raise RuntimeError("set_costmap comes first")
        ends = np.array([[start.x_m, start.y_m], [goal.x_m, goal.y_m]])
        if not np.isfinite(ends).all():
            raise ValueError(f"start and goal must be finite, got {start} and {goal}")
        cells = costmap.map.cells_of(ends)
        inside = np.all((cells >= 0) & (cells < costmap.cost.shape), axis=1)
        if not inside[0]:
            return GridPlan(None, np.inf, "the robot is outside the map")
        free = np.isfinite(costmap.cost)
        if not free.any():
            return GridPlan(None, np.inf, "no place of the map is free")
        first = (int(cells[0, 0]), int(cells[0, 1]))
        if not free[first]:
            first = _nearest(free, first)
        _, part = cv2.connectedComponents(free.astype(np.uint8), connectivity=8)
        reachable = part == part[first]
        last = (int(cells[1, 0]), int(cells[1, 1]))
        if not inside[1] or not reachable[last]:
            return self._refusal(costmap, reachable, last, bool(inside[1]) and bool(free[last]), bool(inside[1]))
        return self._search(costmap, ends, first, last)

    def _search(self, costmap: CostMap, ends: Array, first: tuple[int, int], last: tuple[int, int]) -> GridPlan:
        height, width = costmap.cost.shape
        graph = csr_array((self._weights.ravel(), self._columns, self._rows), shape=(height * width,) * 2)
        source, target = last[0] * width + last[1], first[0] * width + first[1]
        # From the goal, so that every cell's predecessor is its next step.
        cost, next_cell = dijkstra(graph, directed=True, indices=source, return_predecessors=True)
        way, cell = [target], target
        while cell != source:
            cell = int(next_cell[cell])
            if cell == _NO_CELL:
                raise RuntimeError("a reachable cell without a way: the grid and its parts disagree")
            way.append(cell)
        row, column = np.divmod(np.array(way), width)
        points = costmap.map.centres_of(np.column_stack([row, column]))
        if len(points) > 1:
            points[0], points[-1] = ends
            return GridPlan(points, float(cost[target]) * costmap.map.resolution_m)
        return GridPlan(ends.copy(), 0.0)

    def _refusal(
        self, costmap: CostMap, reachable: NDArray[np.bool_], goal: tuple[int, int], goal_is_free: bool, inside: bool
    ) -> GridPlan:
        height, width = costmap.cost.shape
        clipped = (min(max(goal[0], 0), height - 1), min(max(goal[1], 0), width - 1))
        nearest = costmap.map.centres_of(np.array([_nearest(reachable, clipped)]))[0]
        if not inside:
            reason = "the goal is outside the map"
        elif goal_is_free:
            reason = "no way leads to the goal"
        else:
            reason = "the goal is in or too near to an obstacle, or in a forbidden zone"
        return GridPlan(None, np.inf, reason, (float(nearest[0]), float(nearest[1])))

    def _build(self, height: int, width: int) -> None:
        """The grid's edges; those across its border lead nowhere and cost inf."""
        self._padded = np.full((height + 2, width + 2), np.inf)
        self._weights = np.full((height, width, len(_NEIGHBOURS)), np.inf)
        number = np.zeros((height + 2, width + 2), np.int32)
        number[1:-1, 1:-1] = np.arange(height * width, dtype=np.int32).reshape(height, width)
        shifted = [number[1 + up : height + 1 + up, 1 + right : width + 1 + right] for up, right in _NEIGHBOURS]
        self._columns = np.stack(shifted, axis=-1).ravel()
        self._rows = np.arange(0, len(_NEIGHBOURS) * height * width + 1, len(_NEIGHBOURS), dtype=np.int32)

    def _reweigh(self, top: int, bottom: int, left: int, right: int) -> None:
        """Weights of the edges that leave the cells of a window."""
        here = self._padded[top + 1 : bottom + 1, left + 1 : right + 1]
        for number, (up, across) in enumerate(_NEIGHBOURS):
            there = self._padded[top + 1 + up : bottom + 1 + up, left + 1 + across : right + 1 + across]
            self._weights[top:bottom, left:right, number] = (here + there) * (0.5 * np.hypot(up, across))


def _nearest(allowed: NDArray[np.bool_], cell: tuple[int, int]) -> tuple[int, int]:
    """The allowed cell nearest to ``cell``."""
    cells = np.argwhere(allowed)
    row, column = cells[np.argmin(((cells - np.array(cell)) ** 2).sum(axis=1))]
    return int(row), int(column)
