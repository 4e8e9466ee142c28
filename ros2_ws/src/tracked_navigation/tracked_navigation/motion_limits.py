"""Whether a trajectory can be driven."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tracked_description import Robot
from tracked_types import Trajectory

Array = NDArray[np.float64]
_ROUNDING = 1.0 + 1e-9  # a reference exactly at its limit is feasible


@dataclass(frozen=True, slots=True, kw_only=True)
class MotionLimits:
    """What a reference may ask of the base: (5.2.5), and the rates and track speeds it leaves out (erratum 5.2.5)."""

    speed_min_mps: float
    speed_max_mps: float
    yaw_rate_radps: float
    acceleration_mps2: float
    yaw_acceleration_radps2: float
    track_speed_mps: float
    half_gauge_m: float

    @classmethod
    def from_robot(cls, robot: Robot, share: float = 1.0) -> "MotionLimits":
        """The limits of ``robot`` times ``share``, so that a controller keeps the rest for corrections."""
        limits = robot.limits
        return cls(
            speed_min_mps=limits.speed_min_mps * share,
            speed_max_mps=limits.speed_max_mps * share,
            yaw_rate_radps=limits.yaw_rate_max_radps * share,
            acceleration_mps2=min(limits.acceleration_mps2, limits.braking_mps2) * share,
            yaw_acceleration_radps2=limits.yaw_acceleration_radps2 * share,
            track_speed_mps=robot.tracks.speed_limit_mps * share,
            half_gauge_m=robot.tracks.gauge_m / 2.0,
        )


@dataclass(frozen=True, slots=True)
class Violation:
    """A point of a trajectory that asks too much, and what it asks."""

    index: int
    reason: str


def find_violation(trajectory: Trajectory, limits: MotionLimits) -> Violation | None:
    """Why ``trajectory`` cannot be driven within ``limits``, or None.

    Of the quantity that first exceeds its limit, the worst point is named. Rates are those between
    neighbouring points and count against the later one.
    """
    speeds, yaw_rates = trajectory.inputs[:, 0], trajectory.inputs[:, 1]
    periods = np.diff(trajectory.times_s)
    tracks = np.abs(speeds) + limits.half_gauge_m * np.abs(yaw_rates)
    accelerations = _rates(speeds, periods)
    yaw_accelerations = _rates(yaw_rates, periods)
    checks: tuple[tuple[str, str, Array, float, float], ...] = (
        ("a speed", "m/s", speeds, limits.speed_min_mps, limits.speed_max_mps),
        ("a yaw rate", "rad/s", yaw_rates, -limits.yaw_rate_radps, limits.yaw_rate_radps),
        ("a track speed", "m/s", tracks, 0.0, limits.track_speed_mps),
        ("an acceleration", "m/s2", accelerations, -limits.acceleration_mps2, limits.acceleration_mps2),
        (
            "a yaw acceleration",
            "rad/s2",
            yaw_accelerations,
            -limits.yaw_acceleration_radps2,
            limits.yaw_acceleration_radps2,
        ),
    )
    violations = [found for check in checks if (found := _violation(*check)) is not None]
    return min(violations, key=lambda found: found[0])[1] if violations else None


def _rates(values: Array, periods: Array) -> Array:
    return np.concatenate(([0.0], np.diff(values) / periods))


def _violation(quantity: str, unit: str, values: Array, low: float, high: float) -> tuple[int, Violation] | None:
    """First index beyond the limits, and the worst point."""
    excess = np.maximum(values - high * _ROUNDING, low * _ROUNDING - values)
    excess[~np.isfinite(values)] = np.inf
    beyond = np.flatnonzero(excess > 0.0)
    if beyond.size == 0:
        return None
    worst = int(np.argmax(excess))
    value = float(values[worst])
    limit = low if value < low else high
    return int(beyond[0]), Violation(worst, f"needs {quantity} of {value:.3g} {unit}, the limit is {limit:.3g}")
