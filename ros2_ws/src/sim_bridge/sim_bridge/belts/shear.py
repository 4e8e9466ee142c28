"""Shear between belt and ground: bristles that travel with the belt (Janosi-Hanamoto with transport)."""

import math

from sim_bridge.belts.parameters import BeltParameters
from sim_bridge.belts.state import Array, BeltState
from sim_bridge.compiled import compiled

# Shear beyond this multiple of the shear displacement changes nothing (1 - exp(-4) = 0.98) and is not remembered.
_SATURATION = 4.0


@compiled
def shear_stress(
    p: BeltParameters,
    state: BeltState,
    load: Array,
    slide: Array,
    friction: Array,
    stress: Array,
    damping: Array,
    dt: float,
) -> None:
    """Advance the bristles of every bar by ``dt``; shear force per newton of normal load into ``stress``.

    ``load``: (2, bars) normal load (N). ``slide``: (2, bars, 2) velocity of the belt's outer side on the ground, along
    and across the belt (m/s). ``friction``: (2, bars, 2) coefficients. ``stress``: (2, bars, 2), filled.
    ``damping``: (2,), filled: derivative of each belt's ground force by its speed (N s/m), for the drive.
    """
    bars = load.shape[1]
    for side in range(2):
        speed = state.belt_speed[side]
        damping[side] = 0.0
        # Belt laid down at the front carries no shear. The bars are visited against the belt's motion, so that
        # each still finds its upstream neighbour's shear of the step before.
        moved = min(abs(speed) * dt / p.wheel_spacing, 1.0)
        upstream = 1 if speed >= 0.0 else -1
        for index in range(bars):
            bar = index if upstream > 0 else bars - 1 - index
            stress[side, bar, 0] = stress[side, bar, 1] = 0.0
            if load[side, bar] <= 0.0:
                state.shear[side, bar, 0] = state.shear[side, bar, 1] = 0.0
                continue
            for axis in range(2):
                fresh = state.shear[side, bar + upstream, axis] if 0 <= bar + upstream < bars else 0.0
                state.shear[side, bar, axis] += moved * (fresh - state.shear[side, bar, axis])
                state.shear[side, bar, axis] += slide[side, bar, axis] * dt
            size = math.hypot(state.shear[side, bar, 0], state.shear[side, bar, 1])
            largest = _SATURATION * p.shear_displacement
            if size > largest:
                state.shear[side, bar, 0] *= largest / size
                state.shear[side, bar, 1] *= largest / size
                size = largest
            left = math.exp(-size / p.shear_displacement)
            along, across = friction[side, bar, 0], friction[side, bar, 1]
            spring = (1.0 - left) / size if size > 1e-12 else 1.0 / p.shear_displacement
            damper = p.shear_damping * left
            first = -spring * state.shear[side, bar, 0] * along - damper * slide[side, bar, 0]
            second = -spring * state.shear[side, bar, 1] * across - damper * slide[side, bar, 1]
            excess = math.hypot(first / along, second / across)
            if excess > 1.0:
                first, second = first / excess, second / excess
            stress[side, bar, 0], stress[side, bar, 1] = first, second
            damping[side] += load[side, bar] * (damper + spring * left * along * dt)
