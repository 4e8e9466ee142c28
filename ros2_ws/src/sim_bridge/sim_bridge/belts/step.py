"""One step of the belt-force model: from contacts to the force and torque on the chassis."""

import math

import numpy as np

from sim_bridge.belts.drives import drive_belt
from sim_bridge.belts.ground import assign_friction, touch_floor
from sim_bridge.belts.normal_load import share_of_nodes, solve_loads
from sim_bridge.belts.parameters import LOCKED, BeltParameters
from sim_bridge.belts.shear import shear_stress
from sim_bridge.belts.state import Array, BeltState, Contacts, Workspace
from sim_bridge.compiled import compiled

# A normal this close to the lateral axis means that the belt's side touches: it is pushed, but its friction is none
# of the belt's outer side.
_SIDEWAYS = 0.7


@compiled
def push(wrench: Array, arm: Array, contacts: Contacts, contact: int, x: float, y: float, z: float) -> None:
    """Add a force (x, y, z) at ``arm`` from the centre of mass to the wrench."""
    wrench[0] += x
    wrench[1] += y
    wrench[2] += z
    wrench[3] += arm[contact, 1] * z - arm[contact, 2] * y
    wrench[4] += arm[contact, 2] * x - arm[contact, 0] * z
    wrench[5] += arm[contact, 0] * y - arm[contact, 1] * x


@compiled
def tangents(work: Workspace, contacts: Contacts, contact: int, along: Array, across: Array) -> None:
    """Unit vectors along the belt and across it in the contact's tangent plane."""
    side, bar = contacts.side[contact], contacts.bar[contact]
    normal = contacts.normal[contact]
    lean = 0.0
    for axis in range(3):
        along[axis] = work.nodes[side, bar + 1, axis] - work.nodes[side, bar, axis]
        lean += along[axis] * normal[axis]
    length = 0.0
    for axis in range(3):
        along[axis] -= lean * normal[axis]
        length += along[axis] ** 2
    length = math.sqrt(max(length, 1e-12))
    for axis in range(3):
        along[axis] /= length
    across[0] = normal[1] * along[2] - normal[2] * along[1]
    across[1] = normal[2] * along[0] - normal[0] * along[2]
    across[2] = normal[0] * along[1] - normal[1] * along[0]


@compiled
def advance_belts(
    p: BeltParameters,
    state: BeltState,
    work: Workspace,
    contacts: Contacts,
    count: int,
    zones: Array,
    body: tuple[float, ...],
    left_target: float,
    right_target: float,
    dt: float,
) -> int:
    """Advance belts, wheels and drives by ``dt`` and fill ``work.wrench``; the number of contacts.

    ``count`` contacts with bodies are already in ``contacts``; those with the floor are added here. ``body``: as in
    `place_belts`. Contact forces on the robot are left in ``contacts.force``.
    """
    count = touch_floor(work, contacts, count)
    assign_friction(p, contacts, count, zones)
    rotation, wrench = work.rotation, work.wrench
    bars = work.load.shape[1]
    arm, slip = np.empty((count, 3)), np.empty((count, 3))
    approach, ahead, upward = np.empty(count), np.empty(count), np.empty(count)
    along, across = np.zeros((count, 3)), np.zeros((count, 3))
    for contact in range(count):
        normal = contacts.normal[contact]
        for axis in range(3):
            arm[contact, axis] = contacts.position[contact, axis] - body[axis]
        for axis in range(3):
            nxt, last = (axis + 1) % 3, (axis + 2) % 3
            turning = body[10 + nxt] * arm[contact, last] - body[10 + last] * arm[contact, nxt]
            slip[contact, axis] = body[7 + axis] + turning - contacts.surface_velocity[contact, axis]
        approach[contact] = -(
            slip[contact, 0] * normal[0] + slip[contact, 1] * normal[1] + slip[contact, 2] * normal[2]
        )
        upward[contact] = normal[0] * rotation[0, 2] + normal[1] * rotation[1, 2] + normal[2] * rotation[2, 2]
        ahead[contact] = share_of_nodes(work, contacts, contact)

    unit_force = np.empty_like(state.travel)
    solve_loads(p, state, work, contacts, count, approach, ahead, upward, unit_force, dt)

    wrench[:] = 0.0
    work.load[:] = 0.0
    work.thrust[:] = 0.0
    slide, friction = np.zeros((2, bars, 2)), np.zeros((2, bars, 2))
    gripping = np.zeros(count)
    for contact in range(count):
        load, normal = contacts.load[contact], contacts.normal[contact]
        contacts.force[contact, :] = load * normal
        if load <= 0.0:
            continue
        side, bar = contacts.side[contact], contacts.bar[contact]
        # A wheel takes the part along the chassis' z axis; idlers and the wheels' guides pass on the rest.
        fixed = 1.0
        if p.law != LOCKED:
            fixed = (ahead[contact] if bar == bars - 1 else 0.0) + (1.0 - ahead[contact] if bar == 0 else 0.0)
        by_wheel = load * upward[contact] * (1.0 - fixed)
        push(
            wrench,
            arm,
            contacts,
            contact,
            load * normal[0] - by_wheel * rotation[0, 2],
            load * normal[1] - by_wheel * rotation[1, 2],
            load * normal[2] - by_wheel * rotation[2, 2],
        )
        sideways = normal[0] * rotation[0, 1] + normal[1] * rotation[1, 1] + normal[2] * rotation[2, 1]
        if abs(sideways) > _SIDEWAYS:
            continue
        gripping[contact] = load
        tangents(work, contacts, contact, along[contact], across[contact])
        work.load[side, bar] += load
        for axis in range(3):
            slide[side, bar, 0] += load * slip[contact, axis] * along[contact, axis]
            slide[side, bar, 1] += load * slip[contact, axis] * across[contact, axis]
        friction[side, bar, 0] += load * contacts.friction[contact, 0]
        friction[side, bar, 1] += load * contacts.friction[contact, 1]
    for side in range(2):
        for bar in range(bars):
            if work.load[side, bar] > 0.0:
                slide[side, bar] /= work.load[side, bar]
                slide[side, bar, 0] -= state.belt_speed[side]
                friction[side, bar] /= work.load[side, bar]

    stress, damping = np.zeros((2, bars, 2)), np.zeros(2)
    shear_stress(p, state, work.load, slide, friction, stress, damping, dt)
    for contact in range(count):
        if gripping[contact] <= 0.0:
            continue
        side, bar = contacts.side[contact], contacts.bar[contact]
        first, second = gripping[contact] * stress[side, bar, 0], gripping[contact] * stress[side, bar, 1]
        work.thrust[side] += first
        x = first * along[contact, 0] + second * across[contact, 0]
        y = first * along[contact, 1] + second * across[contact, 1]
        z = first * along[contact, 2] + second * across[contact, 2]
        push(wrench, arm, contacts, contact, x, y, z)
        contacts.force[contact, 0] += x
        contacts.force[contact, 1] += y
        contacts.force[contact, 2] += z

    carry_unsprung_mass(p, work)
    add_unit_forces(p, work, unit_force)
    drive_belt(p, state, 0, left_target, work.thrust[0], damping[0], np.sum(work.load[0]), dt)
    drive_belt(p, state, 1, right_target, work.thrust[1], damping[1], np.sum(work.load[1]), dt)
    return count


@compiled
def carry_unsprung_mass(p: BeltParameters, work: Workspace) -> None:
    """Scale the contact force for the wheels that the chassis carries along, which the rigid body does not know.

    Along the chassis' x and y axes, and along z too when the suspension is locked, the force accelerates sprung and
    unsprung mass together. The unsprung mass' share of the moments of inertia is in the chassis' own.
    """
    wheels = 2 * (work.load.shape[1] - 1)
    share = p.sprung_mass / (p.sprung_mass + wheels * p.unit_mass)
    rotation, wrench = work.rotation, work.wrench
    upward = wrench[0] * rotation[0, 2] + wrench[1] * rotation[1, 2] + wrench[2] * rotation[2, 2]
    kept = 0.0 if p.law == LOCKED else (1.0 - share) * upward
    for axis in range(3):
        wrench[axis] = share * wrench[axis] + kept * rotation[axis, 2]


@compiled
def add_unit_forces(p: BeltParameters, work: Workspace, unit_force: Array) -> None:
    """Add what the suspension units do to the chassis: forces along its z axis at the wheels' places."""
    rotation, wrench = work.rotation, work.wrench
    wheels = unit_force.shape[1]
    total, roll, pitch = 0.0, 0.0, 0.0
    for side in range(2):
        y = p.half_gauge if side == 0 else -p.half_gauge
        for wheel in range(wheels):
            force = unit_force[side, wheel]
            total += force
            roll += force * y
            pitch -= force * p.wheel_spacing * (wheel - 0.5 * (wheels - 1))
    for axis in range(3):
        wrench[axis] += total * rotation[axis, 2]
        wrench[3 + axis] += roll * rotation[axis, 0] + pitch * rotation[axis, 1]
