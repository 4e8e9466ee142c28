"""Contacts with the floor plane z = 0, and the friction that zones of the world give to contacts."""

import math

from sim_bridge.belts.parameters import BeltParameters
from sim_bridge.belts.state import Array, Contacts, Workspace
from sim_bridge.compiled import compiled


@compiled
def touch_floor(work: Workspace, contacts: Contacts, count: int) -> int:
    """Append the nodes that are below z = 0, half to each neighbouring bar; the new number of contacts."""
    nodes = work.nodes
    bars = nodes.shape[1] - 1
    for side in range(2):
        for node in range(bars + 1):
            depth = -nodes[side, node, 2]
            if depth <= 0.0:
                continue
            for bar in range(max(node - 1, 0), min(node + 1, bars)):
                if count >= contacts.side.shape[0]:
                    return count
                contacts.side[count], contacts.bar[count] = side, bar
                contacts.depth[count], contacts.weight[count] = depth, 0.5
                for axis in range(3):
                    contacts.position[count, axis] = nodes[side, node, axis]
                    contacts.normal[count, axis] = 0.0
                    contacts.surface_velocity[count, axis] = 0.0
                contacts.normal[count, 2] = 1.0
                contacts.friction[count, 0] = contacts.friction[count, 1] = math.nan
                count += 1
    return count


@compiled
def assign_friction(p: BeltParameters, contacts: Contacts, count: int, zones: Array) -> None:
    """Give every contact without friction of its own that of the last zone it lies in, or the world's.

    ``zones``: (., 8) centre x, y, cosine and sine of the heading, half length, half width, longitudinal and
    lateral friction.
    """
    for contact in range(count):
        if not math.isnan(contacts.friction[contact, 0]):
            continue
        longitudinal, lateral = p.friction_longitudinal, p.friction_lateral
        for zone in range(zones.shape[0] - 1, -1, -1):
            x = contacts.position[contact, 0] - zones[zone, 0]
            y = contacts.position[contact, 1] - zones[zone, 1]
            along = zones[zone, 2] * x + zones[zone, 3] * y
            across = zones[zone, 2] * y - zones[zone, 3] * x
            if abs(along) <= zones[zone, 4] and abs(across) <= zones[zone, 5]:
                longitudinal, lateral = zones[zone, 6], zones[zone, 7]
                break
        contacts.friction[contact, 0], contacts.friction[contact, 1] = longitudinal, lateral
