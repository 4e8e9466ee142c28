"""Normal loads: stiff contacts and suspension solved together, linearly implicit in the wheels' rates."""

import numpy as np

from robust_core.plants.x_structure import STANDARD_GRAVITY_MPS2
from sim_bridge.belts.contact_frames import ContactFrames
from sim_bridge.belts.parameters import LOCKED, BeltParameters
from sim_bridge.belts.state import Array, BeltState, Contacts, Workspace
from sim_bridge.belts.suspension_law import unit_law
from sim_bridge.compiled import compiled

# A contact that would pull is dropped and the wheels are solved again, at most this often.
_PASSES = 4


@compiled
def solve_tridiagonal(diagonal: Array, beside: Array, right: Array) -> None:
    """Solve a symmetric tridiagonal system in place; the answer replaces ``right``, the matrix is spent."""
    size = diagonal.shape[0]
    for row in range(1, size):
        factor = beside[row - 1] / diagonal[row - 1]
        diagonal[row] -= factor * beside[row - 1]
        right[row] -= factor * right[row - 1]
    right[size - 1] /= diagonal[size - 1]
    for row in range(size - 2, -1, -1):
        right[row] = (right[row] - beside[row] * right[row + 1]) / diagonal[row]


@compiled
def solve_loads(
    p: BeltParameters,
    state: BeltState,
    work: Workspace,
    contacts: Contacts,
    count: int,
    frames: ContactFrames,
    unit_force: Array,
    dt: float,
) -> None:
    """Normal load of every contact, new rate and travel of every wheel, force of every suspension unit.

    ``unit_force``: (2, wheels), filled: force of each unit on the chassis along its z axis; zero when locked, where
    wheels are part of the chassis and keep their travel.
    """
    wheels = state.travel.shape[1]
    stiffness, damping = np.empty((2, wheels)), np.empty((2, wheels))
    for side in range(2):
        for wheel in range(wheels):
            force, k, c = unit_law(p, state.travel[side, wheel])
            unit_force[side, wheel], stiffness[side, wheel], damping[side, wheel] = force, k, c
    # A contact's load is its constant, and its slope times the rate at which its wheels press on.
    constant, slope, active = np.empty(count), np.empty(count), np.ones(count)
    for contact in range(count):
        slope[contact] = contacts.weight[contact] * (p.contact_stiffness * dt + p.contact_damping)
        constant[contact] = contacts.weight[contact] * p.contact_stiffness * contacts.depth[contact]
        constant[contact] += slope[contact] * frames.approach[contact]
    rate = np.zeros((2, wheels))
    for _ in range(_PASSES):
        if p.law != LOCKED:
            resistance = p.unit_mass / dt + stiffness * dt + damping
            solve_wheel_rates(
                p, state, work, contacts, frames, constant, slope, active, unit_force, resistance, rate, dt
            )
        pulled = False
        for contact in range(count):
            side, front = contacts.side[contact], contacts.bar[contact]
            closing = 0.0
            if front < wheels:
                closing += frames.ahead[contact] * rate[side, front]
            if front >= 1:
                closing += (1.0 - frames.ahead[contact]) * rate[side, front - 1]
            load = constant[contact] + slope[contact] * frames.upward[contact] * closing
            if active[contact] > 0.0 and load < 0.0:
                active[contact] = 0.0
                pulled = True
            contacts.load[contact] = load if active[contact] > 0.0 else 0.0
        if not pulled:
            break
    if p.law == LOCKED:
        unit_force[:] = 0.0
        state.travel_rate[:] = 0.0
        return
    for side in range(2):
        for wheel in range(wheels):
            new_rate = rate[side, wheel]
            unit_force[side, wheel] -= (stiffness[side, wheel] * dt + damping[side, wheel]) * new_rate
            state.travel_rate[side, wheel] = new_rate
            state.travel[side, wheel] += new_rate * dt


@compiled
def solve_wheel_rates(
    p: BeltParameters,
    state: BeltState,
    work: Workspace,
    contacts: Contacts,
    frames: ContactFrames,
    constant: Array,
    slope: Array,
    active: Array,
    unit_force: Array,
    resistance: Array,
    rate: Array,
    dt: float,
) -> None:
    """Rates of all wheels at the end of the step into ``rate`` (2, wheels), with the ``active`` contacts pressing.

    A contact touches at most the two wheels at the ends of its bar, so each side is a tridiagonal system with
    ``resistance`` (2, wheels) on its diagonal.
    """
    wheels = state.travel.shape[1]
    weight = p.unit_mass * STANDARD_GRAVITY_MPS2 * work.rotation[2, 2]
    diagonal, beside = resistance.copy(), np.zeros((2, wheels))
    for side in range(2):
        for wheel in range(wheels):
            momentum = p.unit_mass * state.travel_rate[side, wheel] / dt
            rate[side, wheel] = momentum + unit_force[side, wheel] + weight
    for contact in range(active.shape[0]):
        if active[contact] == 0.0:
            continue
        side, front = contacts.side[contact], contacts.bar[contact]  # the wheel ahead of bar b is wheel b
        rear = front - 1
        to_front = frames.ahead[contact] * frames.upward[contact]
        to_rear = (1.0 - frames.ahead[contact]) * frames.upward[contact]
        if front < wheels:
            rate[side, front] -= to_front * constant[contact]
            diagonal[side, front] += to_front * slope[contact] * to_front
        if rear >= 0:
            rate[side, rear] -= to_rear * constant[contact]
            diagonal[side, rear] += to_rear * slope[contact] * to_rear
        if front < wheels and rear >= 0:
            beside[side, rear] += to_front * slope[contact] * to_rear
    for side in range(2):
        solve_tridiagonal(diagonal[side], beside[side], rate[side])
