"""Bands to start from: along the route, and past what blocks it by either side, before or after."""

from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray

from tracked_navigation.band.blockers import Detour, detours_around_movers, detours_around_obstacles
from tracked_navigation.band.optimizer import INTERVALS
from tracked_navigation.band.pursuit import pursued, turning_time
from tracked_navigation.band.route import Route, arc_lengths, left_of
from tracked_navigation.band.settings import BandSettings
from tracked_navigation.band.surroundings import Surroundings
from tracked_types import Pose2, Twist2, wrap_angle

Array = NDArray[np.float64]
USUAL_STEP_S = 0.27  # between two poses
FEWEST = 8
MOST_WAYS = 4
_BLOCKERS = 2  # whose sides are combined; farther ones are met by a later band
_BACKWARDS_M = 0.8  # to an end no farther than this the robot may also drive in reverse
_LEAST_S = 0.6


@dataclass(frozen=True, slots=True)
class Way:
    """One way along a route: past what blocks it by which side."""

    name: str
    detours: tuple[Detour, ...] = ()
    backwards: bool = False


def ways_along(route: Route, surroundings: Surroundings, settings: BandSettings) -> list[Way]:
    """At most `MOST_WAYS` ways, the shortest first, and backwards if the end is near."""
    room = settings.clearance_m
    obstacles = detours_around_obstacles(route, surroundings, settings.footprint, room)[:_BLOCKERS]
    detours = [tuple(way) for way in product(*(options for options in obstacles if options))]
    detours.sort(key=lambda way: sum(abs(detour.offset_m) for detour in way))
    speed = 0.9 * settings.cruise_mps
    past_mover = detours_around_movers(route, surroundings, settings.footprint, settings.mover_clearance_m, speed)
    if past_mover:
        detours = [detours[0], *((*detours[0], detour) for detour in past_mover), *detours[1:]]
    ways = [Way(" and ".join(detour.name for detour in way) or "along the path", way) for way in detours[:MOST_WAYS]]
    if route.rests and float(route.arcs[-1]) < _BACKWARDS_M:
        ways.append(Way("backwards", backwards=True))
    return ways


def band_along(way: Way, route: Route, start: Pose2, twist: Twist2, settings: BandSettings) -> Array:
    """Nodes (n + 1, 6) from ``start`` along ``route`` by one way."""
    limits, end_yaw = settings.limits, float(route.end[2]) if route.rests else None
    if way.backwards:
        # In reverse the robot is one that looks and moves the other way.
        start = Pose2(start.x_m, start.y_m, wrap_angle(start.yaw_rad + np.pi))
        twist = Twist2(-twist.speed_mps, twist.yaw_rate_radps)
        end_yaw = wrap_angle(float(route.end[2]) + np.pi)
    points = route.points if way.backwards else displaced(route, way.detours)
    speed = max(0.9 * settings.reverse_mps, 0.02) if way.backwards else 0.9 * settings.cruise_mps
    arcs = arc_lengths(points)
    speeds = np.full(len(points), speed)
    for detour in way.detours:
        if detour.wait_s > 0.0:
            before = max(detour.begin_m, 1e-3)
            speeds[arcs < before] = before / (before / speed + detour.wait_s)
    headings = np.arctan2(*(points[[1, -1]] - points[[0, -2]]).T[::-1])
    drive_s = float(np.sum(np.diff(arcs) / speeds[:-1])) + speed / limits.acceleration_mps2
    duration = max(drive_s + turning_time(headings, start.yaw_rad, end_yaw, 0.7 * limits.yaw_rate_radps), _LEAST_S)
    nodes = pursued(points, speeds, start, twist, end_yaw, limits, duration, pose_count(duration))
    if way.backwards:
        nodes[:, 2] -= np.pi
        nodes[:, 3] *= -1.0
    return nodes


def pose_count(duration_s: float) -> int:
    """Intervals of a band that lasts so long."""
    return min(max(round(duration_s / USUAL_STEP_S), FEWEST), INTERVALS)


def displaced(route: Route, detours: tuple[Detour, ...]) -> Array:
    """Points of the route, moved to the left by each detour over its stretch, with gentle flanks."""
    arcs = route.arcs
    shift, weight = np.zeros(len(arcs)), np.zeros(len(arcs))
    for detour in detours:
        if detour.offset_m:
            flank = max(0.4, 1.2 * abs(detour.offset_m))
            rising = np.clip((arcs - detour.begin_m + flank) / flank, 0.0, 1.0)
            falling = np.clip((detour.end_m + flank - arcs) / flank, 0.0, 1.0)
            bump = _smooth(np.minimum(rising, falling))
            shift, weight = shift + bump * detour.offset_m, weight + bump
    if not weight.any():
        return route.points
    shift = shift / np.maximum(weight, 1.0)
    # The ends stay where they are.
    shift *= _smooth(np.clip(arcs / 0.4, 0.0, 1.0)) * _smooth(np.clip((arcs[-1] - arcs) / 0.4, 0.0, 1.0))
    moved: Array = route.points + shift[:, None] * left_of(route.points)
    return moved


def _smooth(share: Array) -> Array:
    eased: Array = share * share * (3.0 - 2.0 * share)
    return eased
