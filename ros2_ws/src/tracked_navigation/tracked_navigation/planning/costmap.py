"""What it costs to be at each place of a map: nothing where there is room, more near obstacles, no way within them."""

import math
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from tracked_description import Footprint, Robot
from tracked_types import OCCUPIED_PERCENT, UNKNOWN, OccupancyMap
from tracked_types.setting import check_settings, setting

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class CostSettings:
    """How much room the robot needs and wants.

    inscribed_m: half the robot's width; a centre nearer than this to an obstacle is a contact however it is turned.
    """

    inscribed_m: float

    occupied_percent: int = setting(OCCUPIED_PERCENT, "cells this likely occupied are obstacles", low=1, high=100)
    unknown_is_obstacle: bool = setting(True, "do not plan through what no scan has seen")
    margin_m: float = setting(0.05, "room to keep beside the robot", unit="m", low=0.0, high=1.0)
    comfort_m: float = setting(
        0.45, "distance from obstacles beyond which more does not matter", unit="m", low=0.0, high=5.0
    )
    steepness: float = setting(6.0, "how fast the cost falls with distance", unit="1/m", low=0.0, high=100.0)
    weight: float = setting(4.0, "cost of a place next to an obstacle over that of a free one", low=0.0, high=100.0)

    def __post_init__(self) -> None:
        check_settings(self)

    @classmethod
    def from_robot(cls, robot: Robot, **tuning: float | int | bool) -> "CostSettings":
        """Settings for ``robot``; ``tuning`` are values of the tunable fields."""
        return cls(inscribed_m=Footprint.from_robot(robot).half_width_m, **tuning)  # type: ignore[arg-type]


@dataclass(frozen=True, slots=True)
class CostMap:
    """Costs on the grid of ``map``: (height, width), 1 and more per metre, inf where the robot must not be."""

    map: OccupancyMap
    cost: Array
    clearance_m: Array

    def at(self, points: Array) -> Array:
        """Cost (n,) at points (n, 2) of the map's frame; inf outside."""
        row, column, inside = self.map.look_up(points)
        found: Array = np.where(inside, self.cost[row, column], np.inf)
        return found


def make_costmap(occupancy_map: OccupancyMap, settings: CostSettings, obstacles: Array | None = None) -> CostMap:
    """Costs of a map, with further ``obstacles`` (n, 2) in its frame that are not on it; those outside are left out."""
    occupancy = occupancy_map.occupancy
    blocked = occupancy >= settings.occupied_percent
    if settings.unknown_is_obstacle:
        blocked |= occupancy == UNKNOWN
    if obstacles is not None and len(obstacles):
        row, column, inside = occupancy_map.look_up(obstacles)
        blocked[row[inside], column[inside]] = True
    free = (~blocked).astype(np.uint8)
    if blocked.any():
        pixels = cv2.distanceTransform(free, cv2.DIST_L2, cv2.DIST_MASK_PRECISE).astype(np.float64)
    else:
        pixels = np.full(occupancy.shape, np.inf)
    clearance = pixels * occupancy_map.resolution_m
    nearest = settings.inscribed_m + settings.margin_m
    beyond = np.clip(clearance - nearest, 0.0, max(settings.comfort_m - nearest, 0.0))
    falling = np.exp(-settings.steepness * beyond)
    least = math.exp(-settings.steepness * max(settings.comfort_m - nearest, 0.0))
    cost = 1.0 + settings.weight * (falling - least)
    cost[clearance < nearest] = np.inf
    return CostMap(occupancy_map, cost, clearance)
