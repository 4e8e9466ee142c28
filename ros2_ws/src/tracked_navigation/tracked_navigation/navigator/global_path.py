"""The global path: planned, looked at again, and kept unless another one is clearly better."""

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tracked_navigation.planning.costmap import CostSettings, make_costmap
from tracked_navigation.planning.grid_planner import GridPlan, GridPlanner
from tracked_navigation.planning.path_smoothing import smooth_path
from tracked_navigation.planning.zones import Zones
from tracked_types import OccupancyMap, Pose2

Array = NDArray[np.float64]
_SEARCHED_M = 1.5  # of path ahead of where the robot was last, in which it is now
_OFF_PATH_M = 1.0  # farther from its path the robot needs another one
_LEGS = 3  # planned ahead where there are goals to pass


@dataclass(frozen=True, slots=True)
class PathAnswer:
    """What came of a look.

    reason: why there is no path, in words; empty if there is one. nearest: the reachable place nearest to the goal.
    by_map: the map itself leaves no way, so that waiting does not help. changed: the path is another one than before.
    """

    changed: bool = False
    reason: str = ""
    nearest: tuple[float, float] | None = None
    by_map: bool = False


class GlobalPath:
    """Way over one map, past goals that are to be passed, to the one to stop at."""

    def __init__(self, occupancy_map: OccupancyMap, settings: CostSettings, zones: Zones, gain: float) -> None:
        self._map, self._settings, self._zones, self._gain = occupancy_map, settings, zones, gain
        self._planner = GridPlanner()
        self._bare = zones.applied_to(make_costmap(occupancy_map, settings))
        self._costmap = self._bare
        self.forget()

    def forget(self) -> None:
        """There are other goals, or the robot is elsewhere."""
        self._path = np.zeros((0, 3))
        self._begin, self._first_leg = 0, 0

    @property
    def ahead(self) -> Array:
        """Poses (n, 3) of the path from about where the robot is on; none if there is no path."""
        return self._path[self._begin :]

    @property
    def left_m(self) -> float:
        """Length of what is ahead."""
        return float(_steps(self.ahead).sum())

    @property
    def first_leg_done(self) -> bool:
        """Whether the robot is past the first of the goals."""
        return len(self._path) > 0 and self._begin >= self._first_leg

    def follow(self, pose: Pose2) -> None:
        """The robot is at ``pose``: what lies behind it is no longer ahead."""
        ahead = self.ahead
        if not len(ahead):
            return
        arcs = np.concatenate([[0.0], np.cumsum(_steps(ahead))])
        near = ahead[arcs <= _SEARCHED_M]
        distance = np.hypot(near[:, 0] - pose.x_m, near[:, 1] - pose.y_m)
        nearest = int(np.argmin(distance))
        self._begin += nearest
        if distance[nearest] > _OFF_PATH_M:
            self.forget()

    def look(self, pose: Pose2, goals: Sequence[Pose2], obstacles: Array) -> PathAnswer:
        """Plan from ``pose`` to the ``goals`` past ``obstacles`` (n, 2) that the map lacks.

        Raises
        ------
        ValueError: if a pose is not finite.
        """
        if len(obstacles):
            self._costmap = self._zones.applied_to(make_costmap(self._map, self._settings, obstacles))
        else:
            self._costmap = self._bare
        self._planner.set_costmap(self._costmap)
        legs: list[Array] = []
        for begin, goal in itertools.pairwise([pose, *goals[:_LEGS]]):
            plan = self._planner.plan(begin, goal)
            if plan.points is None:
                return self._refused(plan, begin, goal)
            legs.append(smooth_path(self._costmap, plan.points, goal))
        fresh = np.concatenate([*[leg[:-1] for leg in legs[:-1]], legs[-1]])
        if len(self.ahead) and self._cost(fresh) >= (1.0 - self._gain) * self._cost(self.ahead):
            return PathAnswer()
        self._path, self._begin, self._first_leg = fresh, 0, len(legs[0]) - 1
        return PathAnswer(changed=True)

    def _refused(self, plan: GridPlan, begin: Pose2, goal: Pose2) -> PathAnswer:
        self.forget()
        self._planner.set_costmap(self._bare)
        bare = self._planner.plan(begin, goal)
        if bare.points is None:
            return PathAnswer(reason=bare.reason, nearest=bare.nearest, by_map=True)
        return PathAnswer(reason=f"{plan.reason} past what the map does not show", nearest=plan.nearest)

    def _cost(self, path: Array) -> float:
        """Metres times cost of a path (n, 3), inf if it leads where the robot must not be; its ends may."""
        return float((_steps(path)[1:-1] * self._costmap.at(path[1:-2, :2])).sum()) if len(path) > 3 else 0.0


def _steps(path: Array) -> Array:
    steps: Array = np.hypot(*np.diff(path[:, :2], axis=0).T)
    return steps
