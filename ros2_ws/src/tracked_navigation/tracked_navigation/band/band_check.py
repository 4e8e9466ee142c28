"""Whether a trajectory may be handed out: every interval of it, not only its nodes."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tracked_description import Footprint
from tracked_navigation.band.clearance import clearances
from tracked_navigation.band.surroundings import Surroundings
from tracked_navigation.motion_limits import MotionLimits

Array = NDArray[np.float64]
_ROUNDING = 1.0 + 1e-5
_START_SHARE = 0.5  # of the room at the start, which may be less than wanted, has to remain
_NEAR_M = 0.3  # what is farther away does not matter to the check


@dataclass(frozen=True, slots=True)
class Finding:
    """reason: why not, in words; empty if the trajectory may be driven. clearance_m: least room along it, inf beyond
    0.3 m. begins_s: until when it may be followed, inf if to its end. contact_s: when the footprint first may touch
    something, inf if never."""

    reason: str
    clearance_m: float
    begins_s: float
    contact_s: float


@dataclass(frozen=True, slots=True)
class BandCheck:
    """Holds trajectories against limits and surroundings."""

    footprint: Footprint
    limits: MotionLimits
    least_clearance_m: float

    def judge(self, times: Array, states: Array, inputs: Array, surroundings: Surroundings) -> Finding:
        """Of times (m,), states (m, 3) and inputs (m, 2) from the robot's present state on."""
        beyond = self._beyond_limits(times, inputs)
        # Between two samples no point of the footprint moves farther than this against anything.
        arm = float(np.hypot(max(self.footprint.front_m, self.footprint.rear_m), self.footprint.half_width_m))
        pace = np.abs(inputs[:, 0]) + arm * np.abs(inputs[:, 1])
        gaps = clearances(times, states, surroundings, self.footprint, _NEAR_M)
        swept = np.maximum(pace[1:], pace[:-1]) * np.diff(times)
        towards = swept.copy()
        if len(surroundings.movers):
            fastest = float(np.hypot(surroundings.movers[:, 2], surroundings.movers[:, 3]).max())
            towards += np.minimum(fastest, 5.0) * np.diff(times)
        room = np.concatenate([gaps[:1], np.minimum(gaps[1:], gaps[:-1]) - 0.5 * swept])
        touching = np.flatnonzero(np.minimum(gaps[1:], gaps[:-1]) - 0.5 * towards <= 0.0)
        contact_s = float(times[touching[0]]) if len(touching) else np.inf
        clearance = float(gaps.min())
        if beyond:
            return Finding(beyond, clearance, 0.0, contact_s)
        if gaps[0] <= 0.0:
            return Finding("an obstacle touches the robot", clearance, 0.0, 0.0)
        needed = min(self.least_clearance_m, _START_SHARE * float(gaps[0]))
        close = np.flatnonzero(room < needed)
        close_s = float(times[close[0]]) if len(close) else np.inf
        begins_s = min(close_s, contact_s)
        if np.isinf(begins_s):
            return Finding("", clearance, np.inf, np.inf)
        if close_s <= contact_s:
            reason = f"{max(float(gaps[close[0]]), 0.0):.2f} m from an obstacle after {close_s:.1f} s"
        else:
            reason = f"in the way of a mover after {contact_s:.1f} s"
        return Finding(reason, clearance, begins_s, contact_s)

    def _beyond_limits(self, times: Array, inputs: Array) -> str:
        """Which limit is exceeded, in words; a start beyond one may last as long as braking takes."""
        limits, spans = self.limits, np.diff(times)
        if (spans <= 0.0).any() or not np.isfinite(inputs).all():
            return "its times do not increase or its inputs are not finite"
        speed, yaw_rate = inputs[:, 0], inputs[:, 1]
        tracks = np.abs(speed) + limits.half_gauge_m * np.abs(yaw_rate)
        slower, calmer = limits.acceleration_mps2 * times, limits.yaw_acceleration_radps2 * times
        checks = (
            ("speed", speed, np.maximum(limits.speed_max_mps, speed[0] - 0.5 * slower)),
            ("speed backwards", -speed, np.maximum(-limits.speed_min_mps, -speed[0] - 0.5 * slower)),
            ("yaw rate", np.abs(yaw_rate), np.maximum(limits.yaw_rate_radps, abs(yaw_rate[0]) - 0.5 * calmer)),
            ("track speed", tracks, np.maximum(limits.track_speed_mps, tracks[0] - 0.5 * slower)),
            ("acceleration", np.abs(np.diff(speed)) / spans, np.full(len(spans), limits.acceleration_mps2)),
            (
                "yaw acceleration",
                np.abs(np.diff(yaw_rate)) / spans,
                np.full(len(spans), limits.yaw_acceleration_radps2),
            ),
        )
        for name, value, allowed in checks:
            over = np.flatnonzero(value > allowed * _ROUNDING + 1e-9)
            if len(over):
                return f"{name} {value[over[0]]:.2f} beyond {allowed[over[0]]:.2f}"
        return ""
