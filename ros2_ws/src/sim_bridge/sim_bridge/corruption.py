"""What the faults that change values do to the samples of each kind of sensor."""

import math
from dataclasses import dataclass, replace
from typing import Protocol, TypeVar

import numpy as np

from tracked_types import ImuSample, LaserScan, TrackSample

Sample = TypeVar("Sample")


@dataclass(frozen=True, slots=True)
class Disturbance:
    """Sum of the faults that act on one sample; ``bias`` and ``jump`` in the units of `faults.Fault`."""

    frozen: bool = False
    bias: float = 0.0
    jump: float = 0.0
    not_a_number: bool = False


class Corruption(Protocol[Sample]):
    """Memory that a disturbed sensor needs; `apply` is called with every sample, disturbed or not."""

    def apply(self, sample: Sample, disturbance: Disturbance) -> Sample:
        """``sample`` as the disturbed sensor reports it."""
        ...


class ImuCorruption:
    """Bias and jump act on the yaw rate."""

    def __init__(self) -> None:
        self._last: ImuSample | None = None

    def apply(self, sample: ImuSample, disturbance: Disturbance) -> ImuSample:
        """See `Corruption`."""
        if disturbance.frozen and self._last is not None:
            sample = replace(self._last, stamp_ns=sample.stamp_ns)
        self._last = sample
        if disturbance.not_a_number:
            nothing = np.full(3, math.nan)
            return replace(sample, angular_velocity_radps=nothing, linear_acceleration_mps2=nothing)
        change = disturbance.bias + disturbance.jump
        if change == 0.0:
            return sample
        return replace(sample, angular_velocity_radps=sample.angular_velocity_radps + np.array([0.0, 0.0, change]))


class ScanCorruption:
    """Bias and jump act on every range."""

    def __init__(self) -> None:
        self._last: LaserScan | None = None

    def apply(self, sample: LaserScan, disturbance: Disturbance) -> LaserScan:
        """See `Corruption`."""
        if disturbance.frozen and self._last is not None:
            sample = replace(self._last, stamp_ns=sample.stamp_ns)
        self._last = sample
        if disturbance.not_a_number:
            return replace(sample, ranges_m=np.full_like(sample.ranges_m, math.nan))
        change = disturbance.bias + disturbance.jump
        if change == 0.0:
            return sample
        return replace(sample, ranges_m=(sample.ranges_m + change).astype(np.float32))


class TracksCorruption:
    """Faults act on both encoders alike; travel and speed stay consistent with each other.

    Counters that stood still or ran away keep the difference when the fault ends, as real ones do.
    """

    def __init__(self, rate_hz: int) -> None:
        self._rate_hz = rate_hz
        self._left_offset_m = 0.0
        self._right_offset_m = 0.0
        self._jump_m = 0.0

    def apply(self, sample: TrackSample, disturbance: Disturbance) -> TrackSample:
        """See `Corruption`."""
        left_speed, right_speed = sample.left_speed_mps or 0.0, sample.right_speed_mps or 0.0
        if disturbance.frozen:
            self._left_offset_m -= left_speed / self._rate_hz
            self._right_offset_m -= right_speed / self._rate_hz
            left_speed = right_speed = 0.0
        self._left_offset_m += disturbance.bias / self._rate_hz
        self._right_offset_m += disturbance.bias / self._rate_hz
        added_speed = disturbance.bias + (disturbance.jump - self._jump_m) * self._rate_hz
        self._jump_m = disturbance.jump
        if disturbance.not_a_number:
            return TrackSample(sample.stamp_ns, math.nan, math.nan, math.nan, math.nan)
        return TrackSample(
            stamp_ns=sample.stamp_ns,
            left_travel_m=sample.left_travel_m + self._left_offset_m + disturbance.jump,
            right_travel_m=sample.right_travel_m + self._right_offset_m + disturbance.jump,
            left_speed_mps=left_speed + added_speed,
            right_speed_mps=right_speed + added_speed,
        )
