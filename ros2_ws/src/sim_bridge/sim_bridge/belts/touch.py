"""From a closest point between a bar of belt and a body to the contacts that the model works with."""

import math

import numpy as np

from sim_bridge.belts.state import Array, Contacts, Workspace
from sim_bridge.compiled import compiled

# Deeper penetration than this (m) is a teleport or an edge case of the closest-point search, not rubber.
_DEPTH_LIMIT = 0.02
# A normal this close to a bar's own length is that of its end face, which a belt does not have.
_END_FACE = 0.9
# Sine of the angle up to which a bar lies flush on the face of a box.
_FLUSH = 0.03
# Distance (m) from a body's surface up to which a point counts as on it.
_ON_SURFACE = 0.001


@compiled
def add_contact(
    work: Workspace,
    contacts: Contacts,
    count: int,
    side: int,
    bar: int,
    point: tuple[float, ...],
    depth: float,
    weight: float,
    friction: tuple[float, float],
    box: Array,
) -> int:
    """Append the contact of one bar with one body; the new number of contacts.

    ``point``: position on the body and normal towards the bar, 6 numbers. ``friction``: NaN where zones decide.
    ``box``: (15,) centre, rotation (row by row) and half extents of the body; no extents if it is no box.

    The closest point of a line or an area of contact is an arbitrary one of many, and another one at the next step.
    On a flat face the bar's two nodes take the contact, as they do on the floor, so that a robot stands on a box as on
    the ground; a line across the belt is represented by its middle.
    """
    nodes = work.nodes
    along, length = 0.0, 0.0
    for axis in range(3):
        edge = nodes[side, bar + 1, axis] - nodes[side, bar, axis]
        along += edge * point[3 + axis]
        length += edge * edge
    along = abs(along) / math.sqrt(length)
    if along > _END_FACE:
        return count
    left = weight
    if along < _FLUSH and box[12] > 0.0:
        face, direction = _face_of(box, point)
        if face >= 0:
            for node in range(bar, bar + 2):
                sunk = _depth_below(box, face, direction, nodes[side, node])
                if 0.0 < sunk < _DEPTH_LIMIT and count < contacts.side.shape[0]:
                    _write(contacts, count, side, bar, nodes[side, node], point, sunk, 0.5 * weight, friction)
                    count += 1
                    left -= 0.5 * weight
    if left > 1e-9 and count < contacts.side.shape[0]:
        position = _on_centre_line(work, side, bar, point, box)
        _write(contacts, count, side, bar, position, point, min(depth, _DEPTH_LIMIT), left, friction)
        count += 1
    return count


@compiled
def _on_centre_line(work: Workspace, side: int, bar: int, point: tuple[float, ...], box: Array) -> Array:
    """The contact's position, in the middle of the belt if a face or an edge of a box touches it in all its width."""
    position = np.array((point[0], point[1], point[2]))
    lateral, aside = 0.0, 0.0
    for axis in range(3):
        lateral += point[3 + axis] * work.rotation[axis, 1]
        aside += (position[axis] - work.nodes[side, bar, axis]) * work.rotation[axis, 1]
    if box[12] > 0.0 and abs(lateral) < _FLUSH:
        middle = position - aside * work.rotation[:, 1]
        for axis in range(3):
            local = 0.0
            for k in range(3):
                local += box[3 + 3 * k + axis] * (middle[k] - box[k])
            if abs(local) > box[12 + axis] + _ON_SURFACE:
                return position
        return middle
    return position


@compiled
def _face_of(box: Array, point: tuple[float, ...]) -> tuple[int, float]:
    """Axis and direction of the face of ``box`` that has the normal of ``point``; axis -1 if there is none."""
    for face in range(3):
        aligned = box[3 + face] * point[3] + box[6 + face] * point[4] + box[9 + face] * point[5]
        if abs(aligned) > 0.999:
            return face, math.copysign(1.0, aligned)
    return -1, 0.0


@compiled
def _depth_below(box: Array, face: int, direction: float, position: Array) -> float:
    """Depth of a point below a face; not positive beside or above the face."""
    depth = 0.0
    for axis in range(3):
        local = 0.0
        for k in range(3):
            local += box[3 + 3 * k + axis] * (position[k] - box[k])
        if axis == face:
            depth = box[12 + axis] - direction * local
        elif abs(local) > box[12 + axis]:
            return -1.0
    return depth


@compiled
def _write(
    contacts: Contacts,
    count: int,
    side: int,
    bar: int,
    position: Array,
    point: tuple[float, ...],
    depth: float,
    weight: float,
    friction: tuple[float, float],
) -> None:
    contacts.side[count], contacts.bar[count] = side, bar
    contacts.depth[count], contacts.weight[count] = depth, weight
    contacts.friction[count, 0], contacts.friction[count, 1] = friction[0], friction[1]
    for axis in range(3):
        contacts.position[count, axis] = position[axis]
        contacts.normal[count, axis] = point[3 + axis]
        contacts.surface_velocity[count, axis] = 0.0
