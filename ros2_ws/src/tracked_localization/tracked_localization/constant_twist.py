"""Exact motion of a body whose forward speed and yaw rate do not change."""

import math
from dataclasses import dataclass

_SMALL_RAD = 1e-4


@dataclass(frozen=True, slots=True)
class TwistStep:
    """Displacement over one step and its partial derivatives.

    x_m, y_m are in the fixed frame; x_per_yaw = dx/dyaw (m/rad), x_per_speed (s), x_per_rate (m s/rad).
    """

    x_m: float
    y_m: float
    yaw_rad: float
    arc_m: float
    x_per_yaw: float
    y_per_yaw: float
    x_per_speed: float
    y_per_speed: float
    x_per_rate: float
    y_per_rate: float


def constant_twist_step(yaw_rad: float, speed_mps: float, yaw_rate_radps: float, duration_s: float) -> TwistStep:
    """Move along an arc from heading ``yaw_rad``: the chord points along the heading at mid-step.

    The midpoint rule with the chord's exact length, so circles close for any step (erratum 5.2.4).
    """
    half = 0.5 * yaw_rate_radps * duration_s
    cosine, sine = math.cos(yaw_rad + half), math.sin(yaw_rad + half)
    if abs(half) < _SMALL_RAD:
        shortening, slope = 1.0 - half * half / 6.0, -half / 3.0
    else:
        shortening = math.sin(half) / half
        slope = (math.cos(half) - shortening) / half
    reach = duration_s * shortening
    chord = speed_mps * reach
    along = 0.5 * speed_mps * duration_s * duration_s * slope
    across = 0.5 * duration_s * chord
    return TwistStep(
        x_m=chord * cosine,
        y_m=chord * sine,
        yaw_rad=yaw_rate_radps * duration_s,
        arc_m=speed_mps * duration_s,
        x_per_yaw=-chord * sine,
        y_per_yaw=chord * cosine,
        x_per_speed=reach * cosine,
        y_per_speed=reach * sine,
        x_per_rate=along * cosine - across * sine,
        y_per_rate=along * sine + across * cosine,
    )
