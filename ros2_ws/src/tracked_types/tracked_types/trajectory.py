"""Stamped planar trajectory."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tracked_types.angles import wrap_angle
from tracked_types.stamps import NANOSECONDS_PER_SECOND, seconds_between

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Trajectory:
    """Poses and inputs at increasing times.

    times_s: (n,) seconds after ``stamp_ns``, strictly increasing, n >= 1.
    states: (n, 3) x (m), y (m), yaw (rad, wrapped) in ``frame_id``.
    inputs: (n, 2) speed (m/s) and yaw rate (rad/s) at the same times.
    """

    stamp_ns: int
    frame_id: str
    times_s: Array
    states: Array
    inputs: Array

    def __post_init__(self) -> None:
        count = len(self.times_s)
        if count == 0:
            raise ValueError("a trajectory needs at least one point")
        if self.states.shape != (count, 3) or self.inputs.shape != (count, 2):
            raise ValueError(
                f"{count} times need states ({count}, 3) and inputs ({count}, 2), "
                f"got {self.states.shape} and {self.inputs.shape}"
            )
        if (self.times_s[1:] <= self.times_s[:-1]).any():
            raise ValueError("times must increase strictly")

    @property
    def start_ns(self) -> int:
        """Stamp of the first point."""
        return self.stamp_ns + round(float(self.times_s[0]) * NANOSECONDS_PER_SECOND)

    @property
    def end_ns(self) -> int:
        """Stamp of the last point."""
        return self.stamp_ns + round(float(self.times_s[-1]) * NANOSECONDS_PER_SECOND)

    def at(self, stamp_ns: int, offsets_s: Array) -> tuple[Array, Array]:
        """States (m, 3) and inputs (m, 2) at ``stamp_ns + offsets_s`` (m,), linear in between.

        The heading is interpolated along the shorter arc. Before the first and after the last point the
        trajectory holds its end poses; inputs there are the end inputs, so a trajectory that is meant to
        end at rest must say so in its last input.
        """
        query = seconds_between(stamp_ns, self.stamp_ns) + offsets_s
        return self._interpolate(query)

    def _interpolate(self, query: Array) -> tuple[Array, Array]:
        times = self.times_s
        if len(times) == 1:
            return np.repeat(self.states, len(query), 0), np.repeat(self.inputs, len(query), 0)
        # A layer asks at every tick, and numpy.clip takes longer than both of its halves.
        lower = np.minimum(np.maximum(times.searchsorted(query, side="right") - 1, 0), len(times) - 2)
        upper = lower + 1
        start = times[lower]
        weight = np.minimum(np.maximum((query - start) / (times[upper] - start), 0.0), 1.0)[:, None]
        states, inputs = self.states[lower], self.inputs[lower]
        step = self.states[upper] - states
        step[:, 2] = wrap_angle(step[:, 2])
        states += weight * step
        states[:, 2] = wrap_angle(states[:, 2])
        inputs += weight * (self.inputs[upper] - inputs)
        return states, inputs
