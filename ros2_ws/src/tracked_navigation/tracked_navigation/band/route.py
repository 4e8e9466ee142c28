"""The piece of the global path that a band spans, and where it ends."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tracked_description import Footprint
from tracked_navigation.band.clearance import clearances
from tracked_navigation.band.surroundings import Surroundings
from tracked_types import Pose2

Array = NDArray[np.float64]
STEP_M = 0.05  # between points of a route
JOIN_M = 0.3  # ahead of the robot's projection, where a route joins the path
SEARCH_M = 0.25
BEYOND_M = 1.5  # how far past the usual end a free one is looked for
LEAST_M = 0.1
ROOMY_M = 0.25


@dataclass(frozen=True, slots=True)
class Route:
    """points: (k, 2), STEP_M or less apart, from the robot to the end. end: (3,) pose. rests: the robot stands at the
    end. reason: in words, why the route does not lead as far as it should; empty if it does."""

    points: Array
    end: Array
    rests: bool
    reason: str = ""

    @property
    def arcs(self) -> Array:
        """Way (k,) from the start to every point."""
        return arc_lengths(self.points)


def route_along(
    path: Array, start: Pose2, lookahead_m: float, surroundings: Surroundings, footprint: Footprint, room_m: float
) -> Route | None:
    """From ``start`` along ``path`` (n, 3) to a place with ``room_m`` about the robot; None if there is none.

    The goal itself if it is within the horizon and free; else a place on the path a little farther on, to be passed;
    else one before what is in the way, to wait at.
    """
    here = np.array([start.x_m, start.y_m])
    arcs = arc_lengths(path[:, :2])
    begin, length = _projection(path[:, :2], arcs, here), float(arcs[-1])
    reaches_goal = length - begin <= lookahead_m
    usual = length if reaches_goal else begin + lookahead_m
    farther = np.arange(usual, min(usual + BEYOND_M, length) + 1e-9, SEARCH_M)
    nearer = np.arange(usual - SEARCH_M, begin + LEAST_M, -SEARCH_M)
    places = np.concatenate([farther, nearer])
    poses = _poses_at(path, arcs, places)
    still = Surroundings(surroundings.points, surroundings.segments, surroundings.thinned, np.zeros((0, 5)))
    room = clearances(np.zeros(len(poses)), poses, still, footprint, ROOMY_M)
    free = np.flatnonzero(room >= room_m)
    if not len(free):
        return None
    # A place right behind an obstacle is a poor one to aim at if there is a roomy one beyond.
    roomy = free[(room[free] >= ROOMY_M) & (free < len(farther))]
    chosen = free[0] if reaches_goal or not len(roomy) else roomy[0]
    arc, end = float(places[chosen]), poses[chosen]
    is_goal, is_short = arc >= length - 1e-9, arc < usual - 1e-9
    reason = ""
    if is_short:
        reason = "the goal is not free" if reaches_goal else "the way ahead is not free"
    return Route(_joined(path, arcs, here, begin, arc), end, is_goal or is_short, reason)


def arc_lengths(points: Array) -> Array:
    """Way (n,) along points (n, 2) from the first."""
    steps = np.hypot(*np.diff(points, axis=0).T)
    return np.concatenate([[0.0], np.cumsum(steps)])


def left_of(points: Array) -> Array:
    """Unit vectors (n, 2) to the left of the way along points (n, 2)."""
    along = np.empty_like(points)
    along[1:-1] = points[2:] - points[:-2]
    along[0], along[-1] = points[1] - points[0], points[-1] - points[-2]
    along /= np.maximum(np.hypot(along[:, 0], along[:, 1]), 1e-9)[:, None]
    return np.column_stack([-along[:, 1], along[:, 0]])


def _joined(path: Array, arcs: Array, here: Array, begin: float, arc: float) -> Array:
    """Points of the way from the robot to the path and along it up to ``arc``."""
    first = min(begin + JOIN_M, arc)
    along = np.linspace(first, arc, max(2, int(np.ceil((arc - first) / STEP_M)) + 1))
    kept = np.column_stack([np.interp(along, arcs, path[:, axis]) for axis in (0, 1)])
    reached = np.concatenate([[0.0], np.hypot(*(kept[:1] - here).T)])
    count = max(2, int(np.ceil(reached[-1] / STEP_M)) + 1)
    towards = here + np.linspace(0.0, 1.0, count)[:-1, None] * (kept[0] - here)
    return np.concatenate([towards, kept])


def _projection(points: Array, arcs: Array, here: Array) -> float:
    """Way along the points to the place nearest to ``here``."""
    if len(points) == 1:
        return 0.0
    first, along = points[:-1], np.diff(points, axis=0)
    square = np.maximum((along * along).sum(axis=1), 1e-18)
    share = np.clip(((here - first) * along).sum(axis=1) / square, 0.0, 1.0)
    offset = here - first - share[:, None] * along
    nearest = int(np.argmin((offset * offset).sum(axis=1)))
    return float(arcs[nearest] + share[nearest] * (arcs[nearest + 1] - arcs[nearest]))


def _poses_at(path: Array, arcs: Array, places: Array) -> Array:
    """Poses (m, 3) on the path: at its end the goal's own heading, before it the path's direction."""
    before, here, after = (
        np.column_stack([np.interp(places + step, arcs, path[:, axis]) for axis in (0, 1)]) for step in (-0.1, 0.0, 0.1)
    )
    direction = after - before
    poses = np.column_stack([here, np.arctan2(direction[:, 1], direction[:, 0])])
    poses[places >= arcs[-1] - 1e-9] = path[-1]
    return poses
