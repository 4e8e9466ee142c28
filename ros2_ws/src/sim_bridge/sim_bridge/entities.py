"""The bodies of a running world by name: spawn, delete, look up, move."""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import pybullet
from numpy.typing import NDArray

from sim_bridge.bodies import create_solid
from sim_bridge.solids import Friction, Solid, Vector

Array = NDArray[np.float64]


class EntityError(ValueError):
    """No such entity, or it cannot be used in this way."""


@dataclass(frozen=True, slots=True)
class EntityState:
    """Pose of an entity's centre in the world and its velocities there."""

    position_m: Vector
    roll_pitch_yaw_rad: Vector
    velocity_mps: Vector = (0.0, 0.0, 0.0)
    angular_velocity_radps: Vector = (0.0, 0.0, 0.0)


class Entities:
    """Named bodies in one Bullet world.

    For the belts, in the order of `names`: ``boxes`` (entities, 6) holds axis-aligned bounding boxes, lower and upper
    corner; ``shapes`` (entities, 15) centre, rotation (row by row) and half extents, which are zero unless the entity
    is a box. Only movable bodies' rows change between spawns. ``revision`` counts spawns and deletions.
    """

    def __init__(self, client: int) -> None:
        self._client = client
        self._solids: dict[str, Solid] = {}
        self._ids: dict[str, int] = {}
        self._bodies: list[int] = []
        self._frictions: list[tuple[float, float]] = []
        self._movable: list[int] = []
        self.revision = 0
        self.boxes: Array = np.zeros((0, 6))
        self.shapes: Array = np.zeros((0, 15))

    @property
    def names(self) -> tuple[str, ...]:
        """Names in order of spawning."""
        return tuple(self._solids)

    def solid(self, name: str) -> Solid:
        """What was spawned under this name."""
        self._id(name)
        return self._solids[name]

    def spawn(self, solid: Solid) -> None:
        """Add a body.

        Raises
        ------
        EntityError: if the name is taken.
        """
        if solid.name in self._solids:
            raise EntityError(f"there is already an entity {solid.name!r}")
        self._ids[solid.name] = create_solid(self._client, solid)
        self._solids[solid.name] = solid
        self.revision += 1
        self._index()

    def delete(self, name: str) -> None:
        """Remove a body; raises EntityError if there is none of this name."""
        pybullet.removeBody(self._id(name), physicsClientId=self._client)
        del self._ids[name], self._solids[name]
        self.revision += 1
        self._index()

    def state(self, name: str) -> EntityState:
        """Where an entity is and how it moves; raises EntityError if there is none of this name."""
        body = self._id(name)
        position, orientation = pybullet.getBasePositionAndOrientation(body, physicsClientId=self._client)
        velocity, angular = pybullet.getBaseVelocity(body, physicsClientId=self._client)
        return EntityState(position, pybullet.getEulerFromQuaternion(orientation), velocity, angular)

    def set_state(self, name: str, state: EntityState) -> None:
        """Put an entity somewhere else, and with a mass give it velocities.

        Raises
        ------
        EntityError: if there is none of this name, or a number is not finite.
        """
        body = self._id(name)
        numbers = (*state.position_m, *state.roll_pitch_yaw_rad, *state.velocity_mps, *state.angular_velocity_radps)
        if len(numbers) != 12 or not np.all(np.isfinite(numbers)):
            raise EntityError(f"state of {name!r} is not finite or not complete: {state}")
        orientation = pybullet.getQuaternionFromEuler(state.roll_pitch_yaw_rad)
        pybullet.resetBasePositionAndOrientation(body, state.position_m, orientation, physicsClientId=self._client)
        if self._solids[name].mass_kg > 0.0:
            pybullet.resetBaseVelocity(
                body, state.velocity_mps, state.angular_velocity_radps, physicsClientId=self._client
            )
        self._index()

    def move_to(self, name: str, x_m: float, y_m: float) -> None:
        """Shift an entity to another place, turned and as high as it is; raises EntityError if there is none of it."""
        body = self._id(name)
        (_, _, z), orientation = pybullet.getBasePositionAndOrientation(body, physicsClientId=self._client)
        pybullet.resetBasePositionAndOrientation(body, (x_m, y_m, z), orientation, physicsClientId=self._client)
        self._measure(self._bodies.index(body))

    def body(self, index: int) -> int:
        """Bullet's id of the entity in row ``index`` of `boxes`."""
        return self._bodies[index]

    def friction(self, index: int) -> tuple[float, float]:
        """Longitudinal and lateral friction of the entity in row ``index``, NaN where zones and floor decide."""
        return self._frictions[index]

    def moves(self, index: int) -> bool:
        """Whether the entity in row ``index`` has a mass."""
        return index in self._movable

    def refresh(self) -> None:
        """Follow the movable bodies with `boxes` and `shapes`."""
        for index in self._movable:
            self._measure(index)

    def refresh_all(self) -> None:
        """Follow every body, after something else than a step has moved them."""
        for index in range(len(self._bodies)):
            self._measure(index)

    def _id(self, name: str) -> int:
        if name not in self._ids:
            raise EntityError(f"no entity {name!r}; there are: {', '.join(self._ids) or 'none'}")
        return self._ids[name]

    def _index(self) -> None:
        self._bodies = list(self._ids.values())
        solids = list(self._solids.values())
        self._frictions = [_coefficients(solid.friction) for solid in solids]
        self._movable = [index for index, solid in enumerate(solids) if solid.mass_kg > 0.0]
        self.boxes, self.shapes = np.zeros((len(solids), 6)), np.zeros((len(solids), 15))
        for index, solid in enumerate(solids):
            if solid.shape == "box":
                self.shapes[index, 12:] = 0.5 * np.array(solid.size_m)
            self._measure(index)

    def _measure(self, index: int) -> None:
        lower, upper = pybullet.getAABB(self._bodies[index], -1, physicsClientId=self._client)
        self.boxes[index, :3], self.boxes[index, 3:] = lower, upper
        position, orientation = pybullet.getBasePositionAndOrientation(
            self._bodies[index], physicsClientId=self._client
        )
        self.shapes[index, :3] = position
        self.shapes[index, 3:12] = pybullet.getMatrixFromQuaternion(orientation)

    def __iter__(self) -> Iterator[Solid]:
        return iter(self._solids.values())


def _coefficients(friction: Friction | None) -> tuple[float, float]:
    return (friction.longitudinal, friction.lateral) if friction else (math.nan, math.nan)
