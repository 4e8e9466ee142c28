"""Exact motion of a body whose forward speed and yaw rate do not change."""

import math
from dataclasses import dataclass

_SMALL_RAD = 1e-4
_LARGEST_SLIP_ANGLE_RAD = 0.5


@dataclass(frozen=True, slots=True)
class TwistStep:
    """Displacement over one step and its partial derivatives.

    x_m, y_m are in the fixed frame; x_per_yaw = dx/dyaw (m/rad), x_per_speed (s), x_per_rate (m s/rad),
    x_per_slide (m/s).
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
    x_per_slide: float
    y_per_slide: float


def constant_twist_step(
    yaw_rad: float, speed_mps: float, yaw_rate_radps: float, duration_s: float, slide_s: float = 0.0
) -> TwistStep:
    """Move along an arc from heading ``yaw_rad``: the chord points along the direction of motion at mid-step.

    The midpoint rule with the chord's exact length, so circles close for any step (erratum 5.2.4). A tracked
    robot slides outwards in a curve: it moves ``slide_s`` times the yaw rate off its heading (slip angle).
    """
    half = 0.5 * yaw_rate_radps * duration_s
    slip_angle = min(max(slide_s * yaw_rate_radps, -_LARGEST_SLIP_ANGLE_RAD), _LARGEST_SLIP_ANGLE_RAD)
    direction = yaw_rad + half - slip_angle
    cosine, sine = math.cos(direction), math.sin(direction)
    if abs(half) < _SMALL_RAD:
        shortening, slope = 1.0 - half * half / 6.0, -half / 3.0
    else:
        shortening = math.sin(half) / half
        slope = (math.cos(half) - shortening) / half
    # The forward speed is one leg of a triangle, the slide the other, the chord its long side.
    stretch = duration_s / math.cos(slip_angle)
    reach = stretch * shortening
    chord = speed_mps * reach
    limited = abs(slip_angle) >= _LARGEST_SLIP_ANGLE_RAD
    sliding, tangent = 0.0 if limited else slide_s, math.tan(slip_angle)
    off = 0.0 if limited else chord * yaw_rate_radps
    along = 0.5 * duration_s * speed_mps * stretch * slope + chord * sliding * tangent
    across = chord * (0.5 * duration_s - sliding)
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
        x_per_slide=off * (sine + cosine * tangent),
        y_per_slide=off * (sine * tangent - cosine),
    )
