"""Bullet bodies: the floor, solids of a world and the chassis, with the groups that decide what meets what."""

import pybullet

from sim_bridge.solids import Solid
from tracked_description import Robot

# A ray has the group RAYS: it sees every body whose mask has that bit, so nothing of the robot, wherever the lidar
# is mounted. Proxies are seen by rays and touch nothing.
RAYS, FIXED, MOVABLE, ROBOT, PROXY = 1, 2, 4, 8, 16
_MASKS = {
    FIXED: RAYS | MOVABLE | ROBOT,
    MOVABLE: RAYS | FIXED | MOVABLE | ROBOT,
    ROBOT: FIXED | MOVABLE,
    PROXY: RAYS,
}
_BODY_FRICTION = 0.5
# Walls are grazed, not gripped: the belts, not the chassis, drive.
_CHASSIS_FRICTION = 0.2
_RAIL_HALF_HEIGHT_M = 0.035


def set_group(client: int, body: int, group: int) -> None:
    """Put a body into one of the groups."""
    pybullet.setCollisionFilterGroupMask(body, -1, group, _MASKS[group], physicsClientId=client)


def create_floor(client: int) -> int:
    """The plane z = 0; belts do not look at it, chassis and movable bodies do."""
    shape = pybullet.createCollisionShape(pybullet.GEOM_PLANE, physicsClientId=client)
    body: int = pybullet.createMultiBody(0.0, shape, physicsClientId=client)
    pybullet.changeDynamics(body, -1, lateralFriction=_BODY_FRICTION, physicsClientId=client)
    set_group(client, body, FIXED)
    return body


def create_solid(client: int, solid: Solid) -> int:
    """Body of one solid of a world."""
    if solid.shape == "box":
        half = [0.5 * size for size in solid.size_m]
        shape = pybullet.createCollisionShape(pybullet.GEOM_BOX, halfExtents=half, physicsClientId=client)
    else:
        shape = pybullet.createCollisionShape(
            pybullet.GEOM_CYLINDER, radius=0.5 * solid.size_m[0], height=solid.size_m[2], physicsClientId=client
        )
    body: int = pybullet.createMultiBody(
        solid.mass_kg,
        shape,
        basePosition=solid.position_m,
        baseOrientation=pybullet.getQuaternionFromEuler(solid.roll_pitch_yaw_rad),
        physicsClientId=client,
    )
    friction = solid.friction.longitudinal if solid.friction else _BODY_FRICTION
    # Without sleeping: a sleeping body would not feel a belt's force.
    pybullet.changeDynamics(
        body,
        -1,
        lateralFriction=friction,
        activationState=pybullet.ACTIVATION_STATE_DISABLE_SLEEPING,
        physicsClientId=client,
    )
    set_group(client, body, MOVABLE if solid.mass_kg > 0.0 else FIXED)
    return body


def create_chassis(client: int, robot: Robot) -> int:
    """The sprung body: a box, and a rail over each belt that keeps walls away from it; origin at the centre of mass."""
    chassis, tracks = robot.chassis, robot.tracks
    # The rails stand on the idlers' height, where the belts' own contacts end.
    rail_z = tracks.idler_height_m + _RAIL_HALF_HEIGHT_M - chassis.com_height_m + 0.005
    rail = [tracks.idler_x_m, 0.5 * tracks.belt_width_m, _RAIL_HALF_HEIGHT_M]
    side = 0.5 * tracks.gauge_m
    shape = pybullet.createCollisionShapeArray(
        [pybullet.GEOM_BOX] * 3,
        halfExtents=[list(chassis.half_extents_m), rail, rail],
        collisionFramePositions=[[0.0, 0.0, 0.0], [0.0, side, rail_z], [0.0, -side, rail_z]],
        physicsClientId=client,
    )
    body: int = pybullet.createMultiBody(
        chassis.sprung_mass_kg, shape, basePosition=[0.0, 0.0, chassis.com_height_m], physicsClientId=client
    )
    pybullet.changeDynamics(
        body,
        -1,
        lateralFriction=_CHASSIS_FRICTION,
        linearDamping=0.0,
        angularDamping=0.0,
        localInertiaDiagonal=list(chassis.inertia_kgm2),
        activationState=pybullet.ACTIVATION_STATE_DISABLE_SLEEPING,
        physicsClientId=client,
    )
    set_group(client, body, ROBOT)
    return body
