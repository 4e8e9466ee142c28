"""Obstacles that the guard's benchmark throws in, the ways to them, and what no guard could do better."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from tracked_description import Footprint, Robot
from tracked_types import Pose2, Twist2

Array = NDArray[np.float64]
TURN_RADIUS_M = 0.5


@dataclass(frozen=True, slots=True)
class Thing:
    """Box or cylinder on the floor: size (m) along and across its heading."""

    shape: Literal["box", "cylinder"]
    along_m: float
    across_m: float

    def outline(self, pose: Pose2) -> Array:
        """Points (n, 2) of its outline, some millimetres apart."""
        if self.shape == "cylinder":
            angles = np.linspace(0.0, 2.0 * np.pi, 180, endpoint=False)
            points = 0.5 * self.along_m * np.column_stack([np.cos(angles), np.sin(angles)])
        else:
            side = np.linspace(-0.5, 0.5, 60)
            half = np.full(60, 0.5)
            edges = [(side, half), (side, -half), (half, side), (-half, side)]
            points = np.concatenate([np.column_stack([self.along_m * u, self.across_m * v]) for u, v in edges])
        return pose.transform(points)


def random_thing(random: np.random.Generator) -> Thing:
    """Four in ten are round."""
    if random.uniform() < 0.4:
        diameter = random.uniform(0.06, 0.3)
        return Thing("cylinder", diameter, diameter)
    return Thing("box", random.uniform(0.05, 0.3), random.uniform(0.05, 0.5))


def placing(
    random: np.random.Generator, moving: Twist2, footprint: Footprint, thing: Thing
) -> Callable[[float], Pose2]:
    """Where the thing's middle is in the robot's frame, the farther the larger the number."""
    if abs(moving.speed_mps) < 0.05:  # beside the corner that comes round
        along = random.uniform(0.3, 0.9) * footprint.front_m
        side = math.copysign(1.0, moving.yaw_rate_radps)
        nearest = footprint.half_width_m + 0.5 * thing.across_m
        return lambda reach_m: Pose2(along, side * (nearest + reach_m), 0.0)
    ahead = math.copysign(1.0, moving.speed_mps)
    depth = (footprint.front_m if ahead > 0.0 else footprint.rear_m) + 0.5 * thing.along_m
    there = Pose2(ahead * depth, random.uniform(-0.9, 0.9) * footprint.half_width_m, 0.0)
    return lambda reach_m: after(moving, reach_m / pace_of(moving)).compose(there)


def pace_of(twist: Twist2) -> float:
    """Speed (m/s) of the base, or of about a corner where it turns."""
    return max(abs(twist.speed_mps), TURN_RADIUS_M * abs(twist.yaw_rate_radps))


def after(twist: Twist2, time_s: float) -> Pose2:
    """Where a base that keeps a twist is after so long, in its own frame."""
    turn, way = twist.yaw_rate_radps * time_s, twist.speed_mps * time_s
    chord = way * float(np.sinc(0.5 * turn / np.pi))
    return Pose2(chord * math.cos(0.5 * turn), chord * math.sin(0.5 * turn), turn)


def way_to(outline: Array, moving: Twist2, footprint: Footprint, farthest_m: float) -> float:
    """Way until the robot's outline touches one of the points (n, 2) of its frame; infinite beyond the farthest."""
    for way in np.arange(0.0, farthest_m, 0.001):
        there = after(moving, float(way) / pace_of(moving))
        if footprint.distance(there.inverse().transform(outline)).min() <= 0.0:
            return float(way)
    return math.inf


def slowest_contact(robot: Robot, told: Twist2, moving: Twist2, way_m: float, known_s: float) -> float:
    """Speed after ``way_m`` if each belt brakes as hard as it can once the obstacle is known; 0 if at rest before.

    told: what the belts were told until then; what they slip of it, they slip on.
    """
    step_s, change = 1e-4, 1e-4 * robot.tracks.acceleration_limit_mps2
    begin_s = known_s + robot.control.transport_delay_s
    lag = 1.0 - math.exp(-step_s / robot.tracks.motor_time_constant_s)
    half_gauge_m = 0.5 * robot.tracks.gauge_m
    belts = np.array(
        [told.speed_mps - half_gauge_m * told.yaw_rate_radps, told.speed_mps + half_gauge_m * told.yaw_rate_radps]
    )
    kept_speed = moving.speed_mps / told.speed_mps if told.speed_mps else 0.0
    kept_turn = moving.yaw_rate_radps / told.yaw_rate_radps if told.yaw_rate_radps else 0.0
    (left, right), (left_set, right_set) = belts.tolist(), belts.tolist()
    time_s, gone_m = 0.0, 0.0
    while True:
        twist = Twist2(kept_speed * 0.5 * (left + right), kept_turn * 0.5 * (right - left) / half_gauge_m)
        pace = pace_of(twist)
        if gone_m >= way_m or pace < 1e-3:
            return pace if gone_m >= way_m else 0.0
        if time_s >= begin_s:
            left_set -= math.copysign(min(change, abs(left_set)), left_set)
            right_set -= math.copysign(min(change, abs(right_set)), right_set)
        left, right = left + (left_set - left) * lag, right + (right_set - right) * lag
        gone_m, time_s = gone_m + pace * step_s, time_s + step_s
