"""Incremental encoders on the belts."""

import math

from tracked_types import TrackSample


class BeltEncoders:
    """Counts whole ticks of belt travel; speed is the change of the count over the sampling period.

    The belts move, not the ground: where the tracks slip, the travel differs from the way covered.
    """

    def __init__(self, tick_m: float, rate_hz: int) -> None:
        self._tick_m = tick_m
        self._rate_hz = rate_hz
        self._left = 0
        self._right = 0

    def update(self, left_travel_m: float, right_travel_m: float, stamp_ns: int) -> TrackSample:
        """Sample at belts that have travelled this far since their start."""
        left = math.floor(left_travel_m / self._tick_m)
        right = math.floor(right_travel_m / self._tick_m)
        sample = TrackSample(
            stamp_ns=stamp_ns,
            left_travel_m=left * self._tick_m,
            right_travel_m=right * self._tick_m,
            left_speed_mps=(left - self._left) * self._tick_m * self._rate_hz,
            right_speed_mps=(right - self._right) * self._tick_m * self._rate_hz,
        )
        self._left, self._right = left, right
        return sample
