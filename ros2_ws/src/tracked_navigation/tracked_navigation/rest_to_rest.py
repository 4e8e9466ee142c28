"""Time law of a motion that starts and ends at rest."""

import math

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class RestToRest:
    """Raised-cosine acceleration, cruise, and the mirror image of it: acceleration is continuous.

    Ramps and cruise last whole numbers of ``step_s`` (the rates are lowered a little for that), so motions
    can follow one another on one sampling grid.

    Parameters
    ----------
    distance: how far, in metres or radians, >= 0.
    cruise: largest rate, per second.
    acceleration: largest rate of change of the rate, per second squared.
    step_s: the grid.

    Raises
    ------
    ValueError: if the distance is negative or another number is not positive.
    """

    def __init__(self, distance: float, cruise: float, acceleration: float, step_s: float) -> None:
        if not (distance >= 0.0 and cruise > 0.0 and acceleration > 0.0 and step_s > 0.0):
            raise ValueError(
                "distance must not be negative, and cruise, acceleration and step must be positive; "
                f"got {distance}, {cruise}, {acceleration}, {step_s}"
            )
        self.distance = distance
        # Peak acceleration of a raised-cosine ramp to rate c within time r is pi c / (2 r).
        slowness = math.pi / (2.0 * acceleration)
        cruise = min(cruise, math.sqrt(distance / slowness))
        ramp_steps = _whole(slowness * cruise / step_s)
        self.steps = ramp_steps + (_whole(distance / cruise / step_s) if cruise > 0.0 else 0)
        self.duration_s = self.steps * step_s
        self._ramp_s = ramp_steps * step_s
        self.cruise = distance / (self.duration_s - self._ramp_s) if self.steps else 0.0

    def at(self, times_s: Array) -> tuple[Array, Array]:
        """Distance covered and rate at ``times_s`` (any shape), held at both ends."""
        times = np.clip(times_s, 0.0, self.duration_s)
        if self._ramp_s == 0.0:
            return np.zeros_like(times), np.zeros_like(times)
        mirrored = times > self.duration_s / 2.0
        early = np.where(mirrored, self.duration_s - times, times)
        covered, rate = self._first_half(early)
        return np.where(mirrored, self.distance - covered, covered), rate

    def _first_half(self, times: Array) -> tuple[Array, Array]:
        ramp, cruise = self._ramp_s, self.cruise
        phase = np.minimum(times / ramp, 1.0) * math.pi
        ramped = 0.5 * cruise * (np.minimum(times, ramp) - np.sin(phase) * ramp / math.pi)
        return ramped + cruise * np.maximum(times - ramp, 0.0), 0.5 * cruise * (1.0 - np.cos(phase))


def _whole(steps: float) -> int:
    return math.ceil(steps - 1e-9)
