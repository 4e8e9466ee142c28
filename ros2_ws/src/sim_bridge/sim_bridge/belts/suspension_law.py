"""Force of one suspension unit: the exact X-structure law, a linear spring, or none when locked; and its stops."""

from robust_core.plants import x_structure
from sim_bridge.belts.parameters import QZS, BeltParameters
from sim_bridge.compiled import compiled

_restoring_force = compiled(x_structure.restoring_force)
_tangent_stiffness = compiled(x_structure.tangent_stiffness)
_tangent_damping = compiled(x_structure.tangent_damping)

# Share of the travel between rods lying flat and standing upright in which the law is evaluated: the stops are
# elastic, and beyond its limits the structure does not exist.
_FLAT, _UPRIGHT = 0.01, 0.995


@compiled
def unit_law(p: BeltParameters, travel: float) -> tuple[float, float, float]:
    """Upward force on the chassis (N), tangent stiffness (N/m) and damping (N s/m) at a travel (m)."""
    if p.law == QZS:
        per_layer = 2.0 * p.layers
        low = per_layer * (_FLAT * p.rod_length - p.rest_height)
        high = per_layer * (_UPRIGHT * p.rod_length - p.rest_height)
        y = min(max(travel, low), high)
        force = _restoring_force(y, p.spring, p.rod_length, p.rest_height, p.rest_width, p.layers, p.preload)
        stiffness = _tangent_stiffness(y, p.spring, p.rod_length, p.rest_height, p.rest_width, p.layers, p.preload)
        damping = _tangent_damping(y, p.joint_damping, p.rod_length, p.rest_height, p.layers)
    else:
        force, stiffness, damping = -p.linear_spring * travel, p.linear_spring, p.linear_damping
    stop = p.compression_stop if travel < p.compression_stop else p.extension_stop
    if travel < p.compression_stop or travel > p.extension_stop:
        force += p.stop_stiffness * (stop - travel)
        stiffness += p.stop_stiffness
        damping += p.stop_damping
    return force, stiffness, damping
