"""Things that walk about a world by themselves, person-sized: pillars on a path, at a set pace."""

import math
from functools import cached_property
from typing import Annotated

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, model_validator

from sim_bridge.entities import Entities
from sim_bridge.solids import Colour, Finite, Positive, Solid
from tracked_types import seconds_between
from tracked_types.checked_yaml import CheckedModel

ORANGE: Colour = (0.9, 0.55, 0.2)
_STEP_S = 0.3


class Walker(CheckedModel):
    """A cylinder that walks along ``waypoints_m`` and back, for ever.

    ``begins_s``: until this simulated time it stands at the first waypoint. ``polite_m``: it waits while the robot's
    middle is nearer than this to where it would step; 0: it yields to nobody.
    """

    name: Annotated[str, Field(pattern=r"^[A-Za-z_][A-Za-z0-9_]*$")]
    waypoints_m: Annotated[tuple[tuple[Finite, Finite], ...], Field(min_length=2)]
    speed_mps: Annotated[float, Field(gt=0.0, le=5.0, allow_inf_nan=False)]
    radius_m: Positive = 0.22
    height_m: Positive = 1.6
    polite_m: Annotated[float, Field(ge=0.0, le=10.0, allow_inf_nan=False)] = 0.0
    begins_s: Annotated[float, Field(ge=0.0, le=1e6, allow_inf_nan=False)] = 0.0
    colour: Colour = ORANGE

    @model_validator(mode="after")
    def _goes_somewhere(self) -> "Walker":
        if self.length_m <= 0.0:
            raise ValueError(f"waypoints_m of {self.name!r} lead nowhere")
        return self

    @property
    def length_m(self) -> float:
        """Length of the path, one way."""
        return float(self._course[0][-1])

    @cached_property
    def _course(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Way (n,) to each waypoint and the waypoints (n, 2)."""
        points = np.array(self.waypoints_m)
        return np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))]), points

    def place_m(self, time_s: float) -> tuple[float, float]:
        """Where it is at a simulated time, in the world."""
        arcs, points = self._course
        there_and_back = math.fmod(max(time_s - self.begins_s, 0.0) * self.speed_mps, 2.0 * self.length_m)
        arc = min(there_and_back, 2.0 * self.length_m - there_and_back)
        return float(np.interp(arc, arcs, points[:, 0])), float(np.interp(arc, arcs, points[:, 1]))

    def solid(self) -> Solid:
        """Its body, at the beginning."""
        x, y = self.waypoints_m[0]
        size = (2.0 * self.radius_m, 2.0 * self.radius_m, self.height_m)
        return Solid(self.name, "cylinder", size, (x, y, 0.5 * self.height_m), colour=self.colour)


class Walking:
    """Moves the walkers of a world with simulated time."""

    def __init__(self, walkers: tuple[Walker, ...]) -> None:
        self._walkers = walkers
        self._waited_s = dict.fromkeys((walker.name for walker in walkers), 0.0)
        self._stamp_ns = 0

    def move(self, entities: Entities, stamp_ns: int, robot_m: tuple[float, float]) -> None:
        """Put every walker that is still in the world where it is at ``stamp_ns``; ``robot_m`` is the robot's place."""
        time_s, period_s = seconds_between(stamp_ns, 0), seconds_between(stamp_ns, self._stamp_ns)
        self._stamp_ns = stamp_ns
        for walker in self._walkers:
            if walker.name not in entities.names:
                continue
            place = walker.place_m(time_s - self._waited_s[walker.name])
            if walker.polite_m > 0.0:
                soon = walker.place_m(time_s - self._waited_s[walker.name] + _STEP_S)
                if math.dist(soon, robot_m) < min(walker.polite_m, math.dist(place, robot_m)):
                    self._waited_s[walker.name] += period_s
                    continue
            entities.move_to(walker.name, *place)
