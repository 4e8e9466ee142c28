"""A first band by driving after a point ahead on a polyline: within the limits, and consistent from the start."""

import math

import numpy as np
from numpy.typing import NDArray

from tracked_navigation.band.interval_cost import NODE
from tracked_navigation.motion_limits import MotionLimits
from tracked_types import Pose2, Twist2, wrap_angle

Array = NDArray[np.float64]
_AHEAD_M = 0.35
_TURN_ON_SPOT_RAD = 0.8
_NEAR_M = 0.08  # of the end: what is left is turning
_BRAKING_SHARE = 0.5


def turning_time(headings: Array, start_yaw: float, end_yaw: float | None, yaw_rate_radps: float) -> float:
    """Time (s) that turns on the spot before and after the way take."""
    turns = [abs(wrap_angle(float(headings[0]) - start_yaw))]
    if end_yaw is not None:
        turns.append(abs(wrap_angle(end_yaw - float(headings[-1]))))
    return sum(turn / yaw_rate_radps for turn in turns if turn > 0.3)


def pursued(
    points: Array,
    speeds: Array,
    start: Pose2,
    twist: Twist2,
    end_yaw: float | None,
    limits: MotionLimits,
    duration_s: float,
    intervals: int,
) -> Array:
    """Nodes (n + 1, 6) of a drive after ``points`` (k, 2), evenly spaced, with the wanted speed (k,) at each.

    end_yaw: heading to turn to at the end and to stand in; None if the end is passed.
    """
    step = duration_s / intervals
    gain = limits.acceleration_mps2 * step, limits.yaw_acceleration_radps2 * step
    xs, ys, wanted, last = points[:, 0].tolist(), points[:, 1].tolist(), speeds.tolist(), len(points) - 1
    steps = np.hypot(*np.diff(points, axis=0).T)
    ahead_count = max(1, round(_AHEAD_M / max(float(steps.mean()), 1e-3)))
    nodes = np.zeros((intervals + 1, NODE))
    x, y, yaw, v, w = start.x_m, start.y_m, start.yaw_rad, twist.speed_mps, twist.yaw_rate_radps
    nodes[0] = x, y, yaw, v, w, 0.0
    at = 0
    for index in range(1, intervals + 1):
        while at < last and math.hypot(xs[at + 1] - x, ys[at + 1] - y) <= math.hypot(xs[at] - x, ys[at] - y):
            at += 1
        aim = min(at + ahead_count, last)
        right, up = xs[aim] - x, ys[aim] - y
        distance = math.hypot(xs[last] - x, ys[last] - y) if aim == last else math.inf
        if aim == last and distance < _NEAR_M:
            turn = 0.0 if end_yaw is None else wrap_angle(end_yaw - yaw)
            speed, yaw_rate = (wanted[last], 0.0) if end_yaw is None else (0.0, turn / step)
        else:
            bearing = wrap_angle(math.atan2(up, right) - yaw)
            speed, yaw_rate = wanted[at], 2.0 * math.sin(bearing) * wanted[at] / math.hypot(right, up)
            if abs(bearing) > _TURN_ON_SPOT_RAD:
                speed, yaw_rate = 0.0, bearing / step
            if end_yaw is not None:
                slowest = math.sqrt(2.0 * _BRAKING_SHARE * limits.acceleration_mps2 * distance)
                speed = min(speed, slowest, distance / step)
        yaw_rate = min(max(yaw_rate, -0.9 * limits.yaw_rate_radps), 0.9 * limits.yaw_rate_radps)
        track = abs(speed) + limits.half_gauge_m * abs(yaw_rate)
        speed *= min(1.0, limits.track_speed_mps / max(track, 1e-9))
        v_next = min(max(speed, v - gain[0]), v + gain[0])
        w_next = min(max(yaw_rate, w - gain[1]), w + gain[1])
        turned = 0.5 * (w + w_next) * step
        way, middle = 0.5 * (v + v_next) * step * (1.0 - turned * turned / 24.0), yaw + 0.5 * turned
        x, y, yaw, v, w = x + way * math.cos(middle), y + way * math.sin(middle), yaw + turned, v_next, w_next
        nodes[index] = x, y, yaw, v, w, index * step
    return nodes
