"""Belts against bodies: boxes in place of the belts' straight pieces, asked for their closest points."""

import math

import numpy as np
import pybullet

from sim_bridge.belts.parameters import BeltParameters
from sim_bridge.belts.state import Array, Contacts, Workspace
from sim_bridge.belts.touch import add_contact
from sim_bridge.entities import Entities

HALF_THICKNESS_M = 0.008


class BeltProbes:
    """Finds the contacts of both belts with the entities of a world; the floor is not their concern."""

    def __init__(self, client: int, parameters: BeltParameters, wheels: int) -> None:
        self._client = client
        idler = 0.5 * math.hypot(
            parameters.idler_x - 0.5 * (wheels - 1) * parameters.wheel_spacing,
            parameters.idler_z + parameters.com_height,
        )
        self.half_lengths: Array = np.full(wheels + 1, 0.5 * parameters.wheel_spacing)
        self.half_lengths[0] = self.half_lengths[-1] = idler
        self._shapes = [
            pybullet.createCollisionShape(
                pybullet.GEOM_BOX,
                halfExtents=[length, parameters.belt_half_width, HALF_THICKNESS_M],
                physicsClientId=client,
            )
            for length in self.half_lengths.tolist()
        ]
        self.touched: list[int] = []

    def collect(self, work: Workspace, pairs: int, entities: Entities, contacts: Contacts) -> int:
        """Fill ``contacts`` from the first ``pairs`` of ``work.pairs``; their number. `touched` names the entities."""
        self.touched.clear()
        count, bars = 0, len(self._shapes)
        for row, entity in work.pairs[:pairs].tolist():
            pose = work.bars[row].tolist()
            body = entities.body(entity)
            points = pybullet.getClosestPoints(
                -1,
                body,
                0.0,
                collisionShapeA=self._shapes[row % bars],
                collisionShapePositionA=pose[:3],
                collisionShapeOrientationA=pose[3:],
                physicsClientId=self._client,
            )
            if not points:
                continue
            side, bar = divmod(row, bars)
            first, weight = count, 1.0 / len(points)
            friction, box = entities.friction(entity), entities.shapes[entity]
            for point in points:
                if point[8] < 0.0:
                    place = (*point[6], *point[7])
                    count = add_contact(work, contacts, count, side, bar, place, -point[8], weight, friction, box)
            self.touched.extend([entity] * (count - first))
            if entities.moves(entity):
                for contact in range(first, count):
                    contacts.surface_velocity[contact] = self._velocity_at(body, contacts.position[contact])
        return count

    def push_back(self, entities: Entities, contacts: Contacts) -> None:
        """Apply to the movable entities what they do to the belts, with the opposite sign."""
        for count, entity in enumerate(self.touched):
            if entities.moves(entity) and contacts.load[count] > 0.0:
                pybullet.applyExternalForce(
                    entities.body(entity),
                    -1,
                    (-contacts.force[count]).tolist(),
                    contacts.position[count].tolist(),
                    pybullet.WORLD_FRAME,
                    physicsClientId=self._client,
                )

    def _velocity_at(self, body: int, point: Array) -> Array:
        centre, _ = pybullet.getBasePositionAndOrientation(body, physicsClientId=self._client)
        velocity, angular = pybullet.getBaseVelocity(body, physicsClientId=self._client)
        arm = np.subtract(point, centre)
        moved: Array = np.asarray(velocity) + np.cross(angular, arm)
        return moved
