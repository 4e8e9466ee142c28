"""Belts against bodies: boxes in place of the belts' straight pieces, asked for their closest points."""

import math

import numpy as np
import pybullet

from sim_bridge.belts.parameters import BeltParameters
from sim_bridge.belts.state import CONTACT_CAPACITY, Array, Contacts, Workspace
from sim_bridge.entities import Entities

HALF_THICKNESS_M = 0.008
# Deeper penetration than this is a teleport or an edge case of the closest-point search, not rubber.
_DEPTH_LIMIT_M = 0.02
# A normal this close to a bar's own length is that of its end face, which a belt does not have.
_END_FACE = 0.9


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
        touched: list[int] = []
        bars = len(self._shapes)
        for row, entity in work.pairs[:pairs].tolist():
            pose = work.bars[row].tolist()
            points = pybullet.getClosestPoints(
                -1,
                entities.body(entity),
                0.0,
                collisionShapeA=self._shapes[row % bars],
                collisionShapePositionA=pose[:3],
                collisionShapeOrientationA=pose[3:],
                physicsClientId=self._client,
            )
            side, bar = divmod(row, bars)
            for point in points or ():
                position, normal, distance = point[6], point[7], point[8]
                if distance >= 0.0 or len(touched) >= CONTACT_CAPACITY or _is_end_face(work, side, bar, normal):
                    continue
                count = len(touched)
                contacts.side[count], contacts.bar[count] = side, bar
                contacts.position[count], contacts.normal[count] = position, normal
                contacts.depth[count], contacts.weight[count] = min(-distance, _DEPTH_LIMIT_M), 1.0 / len(points)
                friction = entities.friction(entity)
                contacts.friction[count] = (friction.longitudinal, friction.lateral) if friction else math.nan
                if entities.moves(entity):
                    contacts.surface_velocity[count] = self._velocity_at(entities.body(entity), position)
                else:
                    contacts.surface_velocity[count] = 0.0
                touched.append(entity)
        self.touched = touched
        return len(touched)

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

    def _velocity_at(self, body: int, point: tuple[float, float, float]) -> Array:
        centre, _ = pybullet.getBasePositionAndOrientation(body, physicsClientId=self._client)
        velocity, angular = pybullet.getBaseVelocity(body, physicsClientId=self._client)
        arm = np.subtract(point, centre)
        moved: Array = np.asarray(velocity) + np.cross(angular, arm)
        return moved


def _is_end_face(work: Workspace, side: int, bar: int, normal: tuple[float, float, float]) -> bool:
    edge = work.nodes[side, bar + 1] - work.nodes[side, bar]
    along = float(edge @ np.asarray(normal))
    return abs(along) > _END_FACE * math.sqrt(float(edge @ edge))
