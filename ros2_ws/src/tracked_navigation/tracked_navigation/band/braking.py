"""Ways to come to rest."""

import numpy as np
from numpy.typing import NDArray

from tracked_navigation.band.band_check import BandCheck, Finding
from tracked_navigation.band.rollout import integrated
from tracked_navigation.band.surroundings import Surroundings
from tracked_navigation.motion_limits import MotionLimits
from tracked_types import Pose2, Twist2

Array = NDArray[np.float64]
Samples = tuple[Array, Array, Array]
STEP_S = 0.05


def stops(start: Pose2, twist: Twist2, limits: MotionLimits) -> list[Samples]:
    """Times (m,), states (m, 3) and inputs (m, 2) to rest: speed and yaw rate each as fast as they can, and along the
    arc that the robot is on."""
    speed_s = abs(twist.speed_mps) / limits.acceleration_mps2
    turn_s = abs(twist.yaw_rate_radps) / limits.yaw_acceleration_radps2
    apart, together = (speed_s, turn_s), (max(speed_s, turn_s),) * 2
    return [_ramp(start, twist, durations) for durations in (apart, together)]


def safest_stop(start: Pose2, twist: Twist2, check: BandCheck, surroundings: Surroundings) -> tuple[Samples, Finding]:
    """The first way to rest without a contact, else the one whose contact comes last."""
    found = [(way, check.judge(*way, surroundings)) for way in stops(start, twist, check.limits)]
    return max(found, key=lambda each: each[1].contact_s)


def followed_by_stop(samples: Samples, begin_s: float, limits: MotionLimits) -> Samples:
    """Along ``samples`` up to ``begin_s``, then to rest along the arc that the robot is on then."""
    times, states, inputs = samples
    last = max(int(np.searchsorted(times, begin_s, side="right")) - 1, 0)
    state, (speed, yaw_rate) = states[last], inputs[last].tolist()
    _, (after, way, slowing) = stops(Pose2(*state.tolist()), Twist2(speed, yaw_rate), limits)
    whole = np.concatenate([times[: last + 1], times[last] + after[1:]])
    return whole, np.vstack([states[: last + 1], way[1:]]), np.vstack([inputs[: last + 1], slowing[1:]])


def _ramp(start: Pose2, twist: Twist2, durations_s: tuple[float, float]) -> Samples:
    # Both ends of a ramp are samples, so that no sample rounds its corner.
    grid = np.arange(1, int(max(durations_s) / STEP_S) + 2) * STEP_S
    times = np.unique(np.concatenate([[0.0], grid, [each for each in durations_s if each > 0.0]]))
    times = times[np.concatenate([[True], np.diff(times) > 1e-7])]
    inputs = np.column_stack(
        [
            initial * np.maximum(1.0 - times / duration, 0.0) if duration > 0.0 else np.zeros(len(times))
            for initial, duration in zip((twist.speed_mps, twist.yaw_rate_radps), durations_s, strict=True)
        ]
    )
    return times, integrated(start.as_array(), times, inputs), inputs
