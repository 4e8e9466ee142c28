"""Friction of the floor and of the zones on it."""

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from sim_bridge.solids import Friction
from sim_bridge.world import World
from tracked_description import Robot


@dataclass(frozen=True, slots=True)
class GroundFriction:
    """Friction outside all zones, and the zones' rectangles and coefficients.

    zones: (., 8) centre x, y, cosine and sine of the heading, half length, half width, longitudinal and lateral
    coefficient; of two that overlap the later one counts.
    """

    floor: Friction
    names: tuple[str, ...]
    zones: NDArray[np.float64]

    @classmethod
    def of_world(cls, world: World, robot: Robot) -> "GroundFriction":
        """What a world says; where it is silent, the robot file's ground."""
        ground = robot.ground
        floor = world.friction or Friction(longitudinal=ground.friction_longitudinal, lateral=ground.friction_lateral)
        rows = [
            (
                *zone.centre_m,
                math.cos(zone.yaw_rad),
                math.sin(zone.yaw_rad),
                0.5 * zone.size_m[0],
                0.5 * zone.size_m[1],
                zone.friction.longitudinal,
                zone.friction.lateral,
            )
            for zone in world.friction_zones
        ]
        return cls(floor, tuple(zone.name for zone in world.friction_zones), np.array(rows).reshape(-1, 8))

    def changed(self, friction: Friction, zone: str | None) -> "GroundFriction":
        """A copy with other coefficients for one zone, or (None) for everything outside zones."""
        if zone is None:
            return replace(self, floor=friction)
        if zone not in self.names:
            raise ValueError(f"no friction zone {zone!r}; there are: {', '.join(self.names) or 'none'}")
        zones = self.zones.copy()
        zones[self.names.index(zone), 6:] = friction.longitudinal, friction.lateral
        return replace(self, zones=zones)
