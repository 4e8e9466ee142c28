"""Where the belts are: nodes under idlers and wheels, and the straight bars of belt between them."""

import math

from sim_bridge.belts.parameters import BeltParameters
from sim_bridge.belts.state import Array, BeltState, Workspace
from sim_bridge.compiled import compiled


@compiled
def rotation_from_quaternion(x: float, y: float, z: float, w: float, rotation: Array) -> None:
    """Fill ``rotation`` (3, 3), body to world, from a unit quaternion."""
    rotation[0, 0] = 1.0 - 2.0 * (y * y + z * z)
    rotation[0, 1] = 2.0 * (x * y - z * w)
    rotation[0, 2] = 2.0 * (x * z + y * w)
    rotation[1, 0] = 2.0 * (x * y + z * w)
    rotation[1, 1] = 1.0 - 2.0 * (x * x + z * z)
    rotation[1, 2] = 2.0 * (y * z - x * w)
    rotation[2, 0] = 2.0 * (x * z - y * w)
    rotation[2, 1] = 2.0 * (y * z + x * w)
    rotation[2, 2] = 1.0 - 2.0 * (x * x + y * y)


@compiled
def place_belts(
    p: BeltParameters, state: BeltState, work: Workspace, body: tuple[float, ...], half_thickness: float
) -> None:
    """Fill the rotation, nodes and bars of ``work`` for a chassis pose.

    ``body``: position (3), quaternion (4), velocity (3), angular velocity (3) of the chassis. A bar's centre lies
    ``half_thickness`` above the belt's outer side, so that a box there touches the ground with that side.
    """
    rotation, nodes, bars = work.rotation, work.nodes, work.bars
    qx, qy, qz, qw = body[3], body[4], body[5], body[6]
    rotation_from_quaternion(qx, qy, qz, qw, rotation)
    wheels = state.travel.shape[1]
    for side in range(2):
        y = p.half_gauge if side == 0 else -p.half_gauge
        last_x = 0.0
        last_z = 0.0
        for node in range(wheels + 2):
            if node == 0 or node == wheels + 1:
                x = -p.idler_x if node == 0 else p.idler_x
                z = p.idler_z
            else:
                x = p.wheel_spacing * (node - 1 - 0.5 * (wheels - 1))
                z = p.mount_z - state.travel[side, node - 1] - p.wheel_radius
            for axis in range(3):
                nodes[side, node, axis] = (
                    body[axis] + rotation[axis, 0] * x + rotation[axis, 1] * y + rotation[axis, 2] * z
                )
            if node > 0:
                row = side * (wheels + 1) + node - 1
                # In the body the bar is turned about y only; the world quaternion is the product of both turns.
                slope = math.atan2(z - last_z, x - last_x)
                sine, cosine = math.sin(-0.5 * slope), math.cos(-0.5 * slope)
                bars[row, 3] = qx * cosine - qz * sine
                bars[row, 4] = qy * cosine + qw * sine
                bars[row, 5] = qz * cosine + qx * sine
                bars[row, 6] = qw * cosine - qy * sine
                up_x, up_z = -math.sin(slope) * half_thickness, math.cos(slope) * half_thickness
                for axis in range(3):
                    centre = 0.5 * (nodes[side, node - 1, axis] + nodes[side, node, axis])
                    bars[row, axis] = centre + rotation[axis, 0] * up_x + rotation[axis, 2] * up_z
            last_x, last_z = x, z


@compiled
def find_pairs(work: Workspace, boxes: Array, half_lengths: Array, half_width: float, margin: float) -> int:
    """Pairs of bar and box that may touch, written to ``work.pairs``; their number.

    ``boxes``: (entities, 6) lower and upper corners of axis-aligned boxes in the world. ``half_lengths``: (bars of
    one side,). The bars are taken as if ``margin`` larger on every side.
    """
    count = 0
    bars, rotation = work.bars, work.rotation
    per_side = half_lengths.shape[0]
    for row in range(bars.shape[0]):
        reach = half_lengths[row % per_side]
        for entity in range(boxes.shape[0]):
            apart = False
            for axis in range(3):
                size = reach * math.sqrt(rotation[axis, 0] ** 2 + rotation[axis, 2] ** 2)
                size += half_width * abs(rotation[axis, 1]) + margin
                if bars[row, axis] - size > boxes[entity, 3 + axis] or bars[row, axis] + size < boxes[entity, axis]:
                    apart = True
                    break
            if not apart and count < work.pairs.shape[0]:
                work.pairs[count, 0] = row
                work.pairs[count, 1] = entity
                count += 1
    return count


@compiled
def locate(
    p: BeltParameters,
    state: BeltState,
    work: Workspace,
    body: tuple[float, ...],
    boxes: Array,
    half_lengths: Array,
    half_thickness: float,
) -> int:
    """`place_belts`, then `find_pairs`: the number of pairs of bar and entity to be looked at closely."""
    place_belts(p, state, work, body, half_thickness)
    if boxes.shape[0] == 0:
        return 0
    return find_pairs(work, boxes, half_lengths, p.belt_half_width, half_thickness)
