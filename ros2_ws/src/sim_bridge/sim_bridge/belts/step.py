"""One step of the belt-force model: from contacts to the force and torque on the chassis."""

import numpy as np

from sim_bridge.belts.contact_frames import ContactFrames, frame_contacts
from sim_bridge.belts.drives import drive_belt
from sim_bridge.belts.ground import assign_friction, touch_floor
from sim_bridge.belts.normal_load import solve_loads
from sim_bridge.belts.parameters import LOCKED, BeltParameters
from sim_bridge.belts.shear import shear_stress
from sim_bridge.belts.state import Array, BeltState, Contacts, Workspace
from sim_bridge.compiled import compiled

# A normal this close to the lateral axis means that the belt's side touches: it is pushed, but its friction is none
# of the belt's outer side.
_SIDEWAYS = 0.7


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
    frames = frame_contacts(work, contacts, count, body)
    unit_force = np.empty_like(state.travel)
    solve_loads(p, state, work, contacts, count, frames, unit_force, dt)
    work.wrench[:] = 0.0
    press(p, work, contacts, count, frames)
    ground_damping = shear(p, state, work, contacts, count, frames, dt)
    carry_unsprung_mass(p, work)
    add_unit_forces(p, work, unit_force)
    for side in range(2):
        target = left_target if side == 0 else right_target
        drive_belt(p, state, side, target, work.thrust[side], ground_damping[side], np.sum(work.load[side]), dt)
    return count


@compiled
def push(work: Workspace, frames: ContactFrames, contact: int, x: float, y: float, z: float) -> None:
    """Add a force (x, y, z) at a contact to the wrench about the centre of mass."""
    wrench, arm = work.wrench, frames.arm[contact]
    wrench[0] += x
    wrench[1] += y
    wrench[2] += z
    wrench[3] += arm[1] * z - arm[2] * y
    wrench[4] += arm[2] * x - arm[0] * z
    wrench[5] += arm[0] * y - arm[1] * x


@compiled
def press(p: BeltParameters, work: Workspace, contacts: Contacts, count: int, frames: ContactFrames) -> None:
    """Add to the wrench what of the normal loads bypasses the suspension.

    A wheel takes the part along the chassis' z axis; idlers and the wheels' guides pass on the rest.
    """
    rotation = work.rotation
    idler_bar = work.load.shape[1] - 1
    for contact in range(count):
        load, normal = contacts.load[contact], contacts.normal[contact]
        for axis in range(3):
            contacts.force[contact, axis] = load * normal[axis]
        fixed = 1.0
        if p.law != LOCKED:
            fixed = frames.ahead[contact] if contacts.bar[contact] == idler_bar else 0.0
            if contacts.bar[contact] == 0:
                fixed += 1.0 - frames.ahead[contact]
        by_wheel = load * frames.upward[contact] * (1.0 - fixed)
        push(
            work,
            frames,
            contact,
            load * normal[0] - by_wheel * rotation[0, 2],
            load * normal[1] - by_wheel * rotation[1, 2],
            load * normal[2] - by_wheel * rotation[2, 2],
        )


@compiled
def shear(
    p: BeltParameters,
    state: BeltState,
    work: Workspace,
    contacts: Contacts,
    count: int,
    frames: ContactFrames,
    dt: float,
) -> Array:
    """Advance the bristles and add their forces to the wrench; (2,) damping of each belt by the ground (N s/m).

    The contacts of one bar share its bristle, each in proportion to its load.
    """
    bars = work.load.shape[1]
    slide, friction, stress = np.zeros((2, bars, 2)), np.zeros((2, bars, 2)), np.zeros((2, bars, 2))
    damping = np.zeros(2)
    work.load[:] = 0.0
    work.thrust[:] = 0.0
    for contact in range(count):
        load = contacts.load[contact]
        if load <= 0.0 or abs(frames.sideways[contact]) > _SIDEWAYS:
            continue
        side, bar = contacts.side[contact], contacts.bar[contact]
        work.load[side, bar] += load
        for axis in range(3):
            slide[side, bar, 0] += load * frames.slip[contact, axis] * frames.along[contact, axis]
            slide[side, bar, 1] += load * frames.slip[contact, axis] * frames.across[contact, axis]
        for axis in range(2):
            friction[side, bar, axis] += load * contacts.friction[contact, axis]
    for side in range(2):
        for bar in range(bars):
            if work.load[side, bar] > 0.0:
                for axis in range(2):
                    slide[side, bar, axis] /= work.load[side, bar]
                    friction[side, bar, axis] /= work.load[side, bar]
                slide[side, bar, 0] -= state.belt_speed[side]
    shear_stress(p, state, work.load, slide, friction, stress, damping, dt)
    for contact in range(count):
        load = contacts.load[contact]
        if load <= 0.0 or abs(frames.sideways[contact]) > _SIDEWAYS:
            continue
        side, bar = contacts.side[contact], contacts.bar[contact]
        first, second = load * stress[side, bar, 0], load * stress[side, bar, 1]
        work.thrust[side] += first
        x = first * frames.along[contact, 0] + second * frames.across[contact, 0]
        y = first * frames.along[contact, 1] + second * frames.across[contact, 1]
        z = first * frames.along[contact, 2] + second * frames.across[contact, 2]
        push(work, frames, contact, x, y, z)
        contacts.force[contact, 0] += x
        contacts.force[contact, 1] += y
        contacts.force[contact, 2] += z
    return damping


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
