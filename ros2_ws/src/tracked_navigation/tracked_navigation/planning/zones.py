"""Zones that people draw on a map: not to be entered, to be crossed slowly, to be preferred."""

from pathlib import Path
from typing import Annotated, Literal

import cv2
import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from tracked_navigation.planning.costmap import CostMap
from tracked_types.checked_yaml import CheckedModel, load_checked_yaml

Array = NDArray[np.float64]
Corner = tuple[
    Annotated[float, Field(allow_inf_nan=False, ge=-1e6, le=1e6)],
    Annotated[float, Field(allow_inf_nan=False, ge=-1e6, le=1e6)],
]


class Zone(CheckedModel):
    """One polygon in the map's frame.

    kind: forbidden, slow (with ``speed_mps``) or preferred. cost: how many times dearer (slow) or cheaper (preferred)
    a metre is there.
    """

    name: Annotated[str, Field(min_length=1)]
    kind: Literal["forbidden", "slow", "preferred"]
    corners: Annotated[tuple[Corner, ...], Field(min_length=3)]
    speed_mps: Annotated[float, Field(gt=0.0, le=10.0)] = 0.2
    cost: Annotated[float, Field(ge=1.0, le=100.0)] = 2.0


class Zones(CheckedModel):
    """All zones of a map; where they overlap, forbidden wins and costs multiply."""

    zones: tuple[Zone, ...] = ()

    def applied_to(self, costmap: CostMap) -> CostMap:
        """The costs with the zones in them.

        What is preferred keeps its cost and everything else becomes dearer, so that costs stay at 1 and above.
        """
        cost = costmap.cost.copy()
        for zone in self.zones:
            inside = _inside(zone, costmap)
            if zone.kind == "forbidden":
                cost[inside] = np.inf
            elif zone.kind == "slow":
                cost[inside] *= zone.cost
            else:
                cost[~inside] *= zone.cost
        return CostMap(costmap.map, cost, costmap.clearance_m)

    def speed_limit_at(self, x_m: float, y_m: float) -> float:
        """The lowest speed of the slow zones around a place (m/s), inf outside all of them."""
        limits = [zone.speed_mps for zone in self.zones if zone.kind == "slow" and _contains(zone, x_m, y_m)]
        return min(limits, default=float("inf"))

    def speed_limit_along(self, path: Array, length_m: float) -> float:
        """The lowest speed of the slow zones on the first ``length_m`` of a path (n, 3), inf if there is none."""
        if not any(zone.kind == "slow" for zone in self.zones):
            return float("inf")
        steps = np.hypot(*np.diff(path[:, :2], axis=0).T)
        near = path[np.concatenate([[0.0], np.cumsum(steps)]) <= length_m]
        return min((self.speed_limit_at(x, y) for x, y, _ in near.tolist()), default=float("inf"))


def load_zones(path: Path) -> Zones:
    """Read zones from YAML.

    Raises
    ------
    CheckedFileError: if the file is missing, is not YAML, or a key is missing, unknown or out of range.
    """
    return load_checked_yaml(Zones, path)


def _contains(zone: Zone, x_m: float, y_m: float) -> bool:
    corners = np.array(zone.corners, np.float32)
    return bool(cv2.pointPolygonTest(corners, (x_m, y_m), False) >= 0.0)


def _inside(zone: Zone, costmap: CostMap) -> NDArray[np.bool_]:
    """The cells whose centres lie in the zone."""
    resolution = costmap.map.resolution_m
    local = costmap.map.origin.inverse().transform(np.array(zone.corners)) / resolution - 0.5
    mask = np.zeros(costmap.cost.shape, np.uint8)
    fraction = 4
    low, high = -(2.0**24), 2.0**24
    corners = np.rint(np.clip(local, low, high) * (1 << fraction)).astype(np.int32)
    cv2.fillPoly(mask, [corners], 1, cv2.LINE_8, fraction)
    return np.asarray(mask, np.bool_)
