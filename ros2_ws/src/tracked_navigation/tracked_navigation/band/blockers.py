"""What stands or crosses in the way of a route, and by which sides it can be passed."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tracked_description import Footprint
from tracked_navigation.band.route import Route, left_of
from tracked_navigation.band.surroundings import Surroundings

Array = NDArray[np.float64]
FARTHEST_DETOUR_M = 2.0
_BESIDE_M = 3.0  # points farther from the route are of no concern
_TIME_STEP_S = 0.1
_LONGEST_WAIT_S = 6.0


@dataclass(frozen=True, slots=True)
class Detour:
    """One way past one blocker. offset_m: to the left of the route, kept from begin_m to end_m along it. wait_s: by how
    much the robot is late at begin_m."""

    name: str
    begin_m: float
    end_m: float
    offset_m: float = 0.0
    wait_s: float = 0.0


@dataclass(frozen=True, slots=True)
class Frenet:
    """Points along (n,) and to the left (n,) of a route."""

    along: Array
    left: Array

    @classmethod
    def of(cls, points: Array, route: Route) -> "Frenet":
        """Points (n, 2) by their nearest points of the route."""
        right, up = points[:, 0:1] - route.points[:, 0], points[:, 1:2] - route.points[:, 1]
        nearest = (right * right + up * up).argmin(axis=1)
        away, left = points - route.points[nearest], left_of(route.points)[nearest]
        ahead = left[:, 1] * away[:, 0] - left[:, 0] * away[:, 1]
        return cls(route.arcs[nearest] + ahead, (away * left).sum(axis=1))


def detours_around_obstacles(
    route: Route, surroundings: Surroundings, footprint: Footprint, room_m: float
) -> list[list[Detour]]:
    """Per obstacle that blocks the route, in order, the ways past it: to the left and to the right where possible."""
    if not len(surroundings.thinned):
        return []
    places = Frenet.of(surroundings.thinned, route)
    length = float(route.arcs[-1])
    half = footprint.half_width_m + room_m
    on_route = (places.along > 0.0) & (places.along < length + footprint.front_m)
    blocking = on_route & (np.abs(places.left) < half)
    if not blocking.any():
        return []
    order = np.sort(places.along[blocking])
    breaks = np.flatnonzero(np.diff(order) > footprint.front_m + footprint.rear_m)
    groups = np.split(order, breaks + 1)
    return [_around(places, float(group[0]), float(group[-1]), footprint, half) for group in groups]


def _around(places: Frenet, first: float, last: float, footprint: Footprint, half: float) -> list[Detour]:
    beside = (places.along > first - 0.15) & (places.along < last + 0.15) & (np.abs(places.left) < _BESIDE_M)
    lefts = np.sort(places.left[beside])
    centre = lefts[np.abs(lefts).argmin()]
    top, bottom = _chained(lefts[lefts >= centre], 2.0 * half), -_chained(-lefts[lefts <= centre][::-1], 2.0 * half)
    begin, end = first - footprint.front_m, last + footprint.rear_m
    options = (("left", top + half), ("right", bottom - half))
    return [
        Detour(f"{name} of what is {max(first, 0.0):.1f} m ahead", begin, end, offset)
        for name, offset in sorted(options, key=lambda option: abs(option[1]))
        if abs(offset) < FARTHEST_DETOUR_M
    ]


def _chained(ascending: Array, gap: float) -> float:
    """The last of the values that the first one reaches by steps of at most ``gap``: the robot fits not between."""
    wide = np.flatnonzero(np.diff(ascending) > gap)
    return float(ascending[wide[0]] if len(wide) else ascending[-1])


def detours_around_movers(
    route: Route, surroundings: Surroundings, footprint: Footprint, room_m: float, speed_mps: float
) -> list[Detour]:
    """Ways past the first mover that the robot would meet: beside it, and after it where it leaves the way."""
    times = np.arange(0.0, float(route.arcs[-1]) / speed_mps + _LONGEST_WAIT_S, _TIME_STEP_S)
    robot = np.minimum(times * speed_mps, float(route.arcs[-1]))
    meetings = []
    for mover in surroundings.movers:
        places = Frenet.of(mover[:2] + times[:, None] * mover[2:4], route)
        half = footprint.half_width_m + float(mover[4]) + room_m
        across = np.abs(places.left) < half
        reach = footprint.front_m + float(mover[4]) + room_m
        met = np.flatnonzero(across & (np.abs(places.along - robot) < reach) & (times * speed_mps < route.arcs[-1]))
        if len(met):
            meetings.append((int(met[0]), places, half, reach, across))
    if not meetings:
        return []
    at, places, half, reach, across = min(meetings, key=lambda meeting: meeting[0])
    place, left = float(places.along[at]), float(places.left[at])
    begin, end = place - reach, place + reach
    name = f"the mover met after {times[at]:.1f} s"
    found = [
        Detour(f"{side} of {name}", begin, end, offset)
        for side, offset in (("left", left + half), ("right", left - half))
        if abs(offset) < FARTHEST_DETOUR_M
    ]
    in_way = np.flatnonzero(across & (times >= times[at]))
    gone = float(times[in_way[-1]])
    stop_before = float(places.along[across].min()) - reach
    if gone < times[-1] - 0.5 and stop_before > 0.0:
        found.append(Detour(f"after {name}", stop_before, stop_before, wait_s=gone - stop_before / speed_mps))
    return found
