"""Named shapes: smooth trajectories from rest to rest, starting at the origin along +x.

All curvatures are continuous along the path and vanish or ramp with the speed, so yaw rates are
continuous in time.
"""

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from tracked_navigation.legs import DriveLeg, Leg, TurnLeg, lay
from tracked_navigation.rest_to_rest import RestToRest
from tracked_navigation.shape_settings import SAMPLE_STEP_S, ShapeSettings
from tracked_types import Trajectory

Array = NDArray[np.float64]
_BESSEL_ANGLES = np.arange(64) * math.pi / 32.0


def bessel_j0(argument: float) -> float:
    """Bessel function J0 as the mean of cos(a cos phi) over the circle: exact to rounding for |a| < 20."""
    return float(np.mean(np.cos(argument * np.cos(_BESSEL_ANGLES))))


FIRST_ZERO_OF_J0 = 2.404825557695773


def build_shape(settings: ShapeSettings) -> Trajectory:
    """The shape that ``settings`` names, in its own frame.

    Whether a robot can drive it is not checked here (see `reference.make_reference`).
    """
    return lay(_BUILDERS[settings.shape](settings), SAMPLE_STEP_S)


def _line(settings: ShapeSettings) -> list[Leg]:
    return [_drive(settings, settings.length_m, np.zeros_like, np.zeros_like, 0.0)]


def _s_curve(settings: ShapeSettings) -> list[Leg]:
    """``swings`` lane changes to alternating sides, each with heading peak * (1 - cos(2 pi u)) / 2.

    One of them ends at (swing length) * J0(peak / 2) * (cos(peak / 2), sin(peak / 2)), which gives peak and
    length from the wished displacement.
    """
    forward = settings.length_m / settings.swings
    peak = 2.0 * math.atan2(settings.width_m, forward)
    swing = math.hypot(forward, settings.width_m) / bessel_j0(peak / 2.0)

    def sign(covered: Array) -> Array:
        index = np.clip(np.floor(covered / swing), 0, settings.swings - 1)
        return np.where(index % 2 == 0, 1.0, -1.0)

    def heading(covered: Array) -> Array:
        return sign(covered) * peak * 0.5 * (1.0 - np.cos(2.0 * math.pi * covered / swing))

    def curvature(covered: Array) -> Array:
        return sign(covered) * peak * math.pi / swing * np.sin(2.0 * math.pi * covered / swing)

    steepest = abs(peak) * math.pi / swing
    return [_drive(settings, swing * settings.swings, heading, curvature, steepest)]


def _circle(settings: ShapeSettings) -> list[Leg]:
    curvature = 1.0 / settings.radius_m
    return [
        _drive(
            settings,
            2.0 * math.pi * settings.radius_m,
            lambda covered: covered * curvature,
            lambda covered: np.full_like(covered, curvature),
            curvature,
        )
    ]


def _figure_eight(settings: ShapeSettings) -> list[Leg]:
    """Heading a (1 - cos(2 pi u)) closes on itself, curvature included, when a is the first zero of J0."""
    length = 4.0 * math.pi * settings.radius_m  # two loops, each as long as a circle of that radius
    wave = 2.0 * math.pi / length
    return [
        _drive(
            settings,
            length,
            lambda covered: FIRST_ZERO_OF_J0 * (1.0 - np.cos(wave * covered)),
            lambda covered: FIRST_ZERO_OF_J0 * wave * np.sin(wave * covered),
            FIRST_ZERO_OF_J0 * wave,
        )
    ]


def _stop_and_turn(settings: ShapeSettings) -> list[Leg]:
    """A regular polygon: drive one side, stop, turn on the spot, and so on; ends at its start pose."""
    side = _line(settings)[0]
    corner = TurnLeg(
        RestToRest(
            2.0 * math.pi / settings.corners,
            settings.turn_rate_radps,
            settings.yaw_acceleration_radps2,
            SAMPLE_STEP_S,
        ),
        +1,
    )
    return [side, corner] * settings.corners


def _drive(
    settings: ShapeSettings,
    length: float,
    heading: Callable[[Array], Array],
    curvature: Callable[[Array], Array],
    steepest: float,
) -> DriveLeg:
    """A drive whose ramps keep both accelerations: the yaw rate grows with the speed, by ``steepest`` at most."""
    acceleration = settings.acceleration_mps2
    if steepest > 0.0:
        acceleration = min(acceleration, settings.yaw_acceleration_radps2 / steepest)
    return DriveLeg(RestToRest(length, settings.speed_mps, acceleration, SAMPLE_STEP_S), heading, curvature)


_BUILDERS: dict[str, Callable[[ShapeSettings], list[Leg]]] = {
    "line": _line,
    "s_curve": _s_curve,
    "circle": _circle,
    "figure_eight": _figure_eight,
    "stop_and_turn": _stop_and_turn,
}
