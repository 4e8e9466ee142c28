"""Bands to start from: along the route, and past what blocks it by either side, before or after."""

from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray

from tracked_navigation.band.blockers import Detour, detours_around_movers, detours_around_obstacles
from tracked_navigation.band.interval_cost import NODE
from tracked_navigation.band.optimizer import INTERVALS
from tracked_navigation.band.route import Route, arc_lengths
from tracked_navigation.band.settings import BandSettings
from tracked_navigation.band.surroundings import Surroundings
from tracked_types import Pose2, Twist2, wrap_angle

Array = NDArray[np.float64]
USUAL_STEP_S = 0.27  # between two poses
FEWEST = 8
MOST_CANDIDATES = 5
_BLOCKERS = 2  # whose sides are combined; farther ones are met by a later band
_TURN_ON_SPOT_RAD = 0.6


@dataclass(frozen=True, slots=True)
class Guess:
    """A band to start from, (n + 1, 6), and which way it takes."""

    name: str
    nodes: Array


def guesses(
    route: Route, start: Pose2, twist: Twist2, surroundings: Surroundings, settings: BandSettings
) -> list[Guess]:
    """At most `MOST_CANDIDATES` bands along ``route``, the shortest first."""
    room = settings.clearance_m
    obstacles = detours_around_obstacles(route, surroundings, settings.footprint, room)[:_BLOCKERS]
    ways = [list(way) for way in product(*(options for options in obstacles if options))]
    ways.sort(key=lambda way: sum(abs(detour.offset_m) for detour in way))
    speed = 0.9 * settings.cruise_mps
    past_mover = detours_around_movers(route, surroundings, settings.footprint, settings.mover_clearance_m, speed)
    if past_mover:
        ways = [ways[0], *([*ways[0], detour] for detour in past_mover), *ways[1:]]
    names = [" and ".join(detour.name for detour in way) or "along the path" for way in ways]
    timelines = [_timeline(route, way, start, speed, settings.limits.yaw_rate_radps) for way in ways[:MOST_CANDIDATES]]
    count = pose_count(float(timelines[0][-1, 3]))
    found = [Guess(name, as_nodes(timeline, count, twist)) for name, timeline in zip(names, timelines, strict=False)]
    if route.rests and len(route.points) * 0.05 < 0.8:
        found.append(Guess("backwards", as_nodes(_backwards(route, start, settings), count, twist)))
    return found


def pose_count(duration_s: float) -> int:
    """Intervals of a band that lasts so long."""
    return min(max(round(duration_s / USUAL_STEP_S), FEWEST), INTERVALS)


def as_nodes(timeline: Array, intervals: int, twist: Twist2) -> Array:
    """Nodes (n + 1, 6) evenly spaced over a timeline (k, 4) of x, y, continuous yaw and time."""
    times = np.linspace(timeline[0, 3], timeline[-1, 3], intervals + 1)
    nodes = np.empty((intervals + 1, NODE))
    for axis in range(3):
        nodes[:, axis] = np.interp(times, timeline[:, 3], timeline[:, axis])
    nodes[:, 5] = times - times[0]
    step = nodes[1, 5]
    rates = np.gradient(nodes[:, :3], step, axis=0)
    nodes[:, 3] = rates[:, 0] * np.cos(nodes[:, 2]) + rates[:, 1] * np.sin(nodes[:, 2])
    nodes[:, 4] = rates[:, 2]
    nodes[0, 3:5] = twist.speed_mps, twist.yaw_rate_radps
    return nodes


def _timeline(route: Route, way: list[Detour], start: Pose2, speed: float, yaw_rate: float) -> Array:
    """The robot turns on the spot where it must, then drives along the route with its detours, then turns again."""
    points = _displaced(route, way)
    arcs = arc_lengths(points)
    times = arcs / speed
    for detour in way:
        if detour.wait_s > 0.0:
            times = times + detour.wait_s * np.clip(arcs / max(detour.begin_m, 1e-3), 0.0, 1.0)
    directions = np.gradient(points, axis=0)
    headings = np.unwrap(np.arctan2(directions[:, 1], directions[:, 0]))
    headings += start.yaw_rad + wrap_angle(float(headings[0]) - start.yaw_rad) - headings[0]
    return _with_turns(points, headings, times, start.yaw_rad, float(route.end[2]), route.rests, 0.8 * yaw_rate)


def _with_turns(
    points: Array, headings: Array, times: Array, start_yaw: float, end_yaw: float, rests: bool, yaw_rate: float
) -> Array:
    drive = np.column_stack([points, headings, times])
    first = abs(headings[0] - start_yaw)
    if first > _TURN_ON_SPOT_RAD:
        drive[:, 3] += first / yaw_rate
        drive = np.vstack([[*points[0], start_yaw, 0.0], drive])
    else:
        drive[0, 2] = start_yaw
    last = wrap_angle(end_yaw - float(drive[-1, 2]))
    if rests and abs(last) > _TURN_ON_SPOT_RAD:
        drive = np.vstack([drive, [*points[-1], drive[-1, 2] + last, drive[-1, 3] + abs(last) / yaw_rate]])
    drive[-1, 3] = max(drive[-1, 3], drive[0, 3] + 0.5)
    keep = np.concatenate([[True], np.diff(drive[:, 3]) > 1e-9])
    keep[-1] = True
    kept: Array = drive[keep]
    return kept


def _backwards(route: Route, start: Pose2, settings: BandSettings) -> Array:
    """Straight to a near end in reverse."""
    ends = np.array([[start.x_m, start.y_m], route.end[:2]])
    way = float(np.hypot(*(ends[1] - ends[0])))
    shares = np.linspace(0.0, 1.0, 10)
    points = ends[0] + shares[:, None] * (ends[1] - ends[0])
    heading = np.arctan2(ends[0, 1] - ends[1, 1], ends[0, 0] - ends[1, 0])
    headings = np.full(10, start.yaw_rad + wrap_angle(float(heading) - start.yaw_rad))
    times = shares * max(way / max(settings.reverse_mps, 0.02), 0.5)
    yaw_rate = 0.8 * settings.limits.yaw_rate_radps
    return _with_turns(points, headings, times, start.yaw_rad, float(route.end[2]), True, yaw_rate)


def _displaced(route: Route, way: list[Detour]) -> Array:
    """Points of the route, moved to the left by each detour over its stretch, with gentle flanks."""
    arcs = route.arcs
    shift, weight = np.zeros(len(arcs)), np.zeros(len(arcs))
    for detour in way:
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
    tangents = np.gradient(route.points, axis=0)
    tangents /= np.maximum(np.hypot(tangents[:, 0], tangents[:, 1]), 1e-9)[:, None]
    return route.points + shift[:, None] * np.column_stack([-tangents[:, 1], tangents[:, 0]])


def _smooth(share: Array) -> Array:
    return share * share * (3.0 - 2.0 * share)
