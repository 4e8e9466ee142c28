"""Each contact as the chassis sees it: where it is, how it moves and which way its friction points."""

import math
from typing import NamedTuple

import numpy as np

from sim_bridge.belts.state import Array, Contacts, Workspace
from sim_bridge.compiled import compiled


class ContactFrames(NamedTuple):
    """Geometry of ``count`` contacts in one step; vectors in the world.

    arm: (count, 3) from the centre of mass. slip: (count, 3) velocity over the touched body of the chassis-fixed point
    there. approach: (count,) speed at which it closes in. ahead: (count,) share of the load that the node ahead takes.
    upward: (count,) component of the normal along the chassis' z axis, sideways: along its y axis.
    along, across: (count, 3) unit vectors in the tangent plane, along the belt and across it.
    """

    arm: Array
    slip: Array
    approach: Array
    ahead: Array
    upward: Array
    sideways: Array
    along: Array
    across: Array


@compiled
def frame_contacts(work: Workspace, contacts: Contacts, count: int, body: tuple[float, ...]) -> ContactFrames:
    """Frames of the first ``count`` contacts; ``body`` as in `place_belts`."""
    rotation = work.rotation
    frames = ContactFrames(
        np.empty((count, 3)),
        np.empty((count, 3)),
        np.zeros(count),
        np.empty(count),
        np.zeros(count),
        np.zeros(count),
        np.empty((count, 3)),
        np.empty((count, 3)),
    )
    for contact in range(count):
        normal = contacts.normal[contact]
        for axis in range(3):
            frames.arm[contact, axis] = contacts.position[contact, axis] - body[axis]
        for axis in range(3):
            nxt, last = (axis + 1) % 3, (axis + 2) % 3
            turning = body[10 + nxt] * frames.arm[contact, last] - body[10 + last] * frames.arm[contact, nxt]
            frames.slip[contact, axis] = body[7 + axis] + turning - contacts.surface_velocity[contact, axis]
            frames.approach[contact] -= frames.slip[contact, axis] * normal[axis]
            frames.upward[contact] += normal[axis] * rotation[axis, 2]
            frames.sideways[contact] += normal[axis] * rotation[axis, 1]
        frames.ahead[contact] = _share_of_node_ahead(work, contacts, contact)
        _tangents(work, contacts, contact, frames.along[contact], frames.across[contact])
    return frames


@compiled
def _share_of_node_ahead(work: Workspace, contacts: Contacts, contact: int) -> float:
    """Lever rule on the bar between two nodes."""
    side, bar = contacts.side[contact], contacts.bar[contact]
    length, along = 0.0, 0.0
    for axis in range(3):
        edge = work.nodes[side, bar + 1, axis] - work.nodes[side, bar, axis]
        length += edge * edge
        along += edge * (contacts.position[contact, axis] - work.nodes[side, bar, axis])
    return min(max(along / length, 0.0), 1.0)


@compiled
def _tangents(work: Workspace, contacts: Contacts, contact: int, along: Array, across: Array) -> None:
    """The bar's direction in the tangent plane, and its left-hand normal there.

    In the contact's plane, not along the bar: on a tilted bar the difference would look like slip.
    """
    side, bar = contacts.side[contact], contacts.bar[contact]
    normal = contacts.normal[contact]
    lean, length = 0.0, 0.0
    for axis in range(3):
        along[axis] = work.nodes[side, bar + 1, axis] - work.nodes[side, bar, axis]
        lean += along[axis] * normal[axis]
    for axis in range(3):
        along[axis] -= lean * normal[axis]
        length += along[axis] ** 2
    length = math.sqrt(max(length, 1e-12))
    for axis in range(3):
        along[axis] /= length
    across[0] = normal[1] * along[2] - normal[2] * along[1]
    across[1] = normal[2] * along[0] - normal[0] * along[2]
    across[2] = normal[0] * along[1] - normal[1] * along[0]
