"""Slip of a track pair from measured belt speeds and gyro."""

from dataclasses import dataclass, replace
from typing import Any

from tracked_description import Robot
from tracked_types import Slip, seconds_between
from tracked_types.setting import check_settings, setting


@dataclass(frozen=True, slots=True, kw_only=True)
class SlipSettings:
    """Geometry and resolution of the track pair, and where slip is no longer defined."""

    gauge_m: float
    encoder_tick_m: float

    standstill_track_speed_mps: float = setting(
        0.03,
        "below this sum of both belts' speeds slip is unknown",
        unit="m/s",
        low=1e-4,
        high=1.0,
    )

    def __post_init__(self) -> None:
        check_settings(self)

    @classmethod
    def from_robot(cls, robot: Robot, **tuning: Any) -> "SlipSettings":
        """Settings for ``robot``; ``tuning`` are values of the tunable fields."""
        return cls(gauge_m=robot.tracks.gauge_m, encoder_tick_m=robot.tracks.encoder_tick_m, **tuning)


def track_slip(left_mps: float, right_mps: float, yaw_rate_radps: float, gauge_m: float) -> tuple[float, float]:
    """What the ground adds to forward speed (m/s) and yaw rate (rad/s) of belts that run at these speeds.

    (5.2.8)-(5.2.11) with the slip ratios cancelled (erratum 5.2.9): the yaw part is the gyro's rate less
    the belts', the forward part follows from the assumption (5.2.8) that the ratios are opposite and
    equal. Its only singularity is standstill, where the answer is zero; one stopped track is regular.
    """
    belt_yaw_rate = (right_mps - left_mps) / gauge_m
    total = abs(left_mps) + abs(right_mps)
    if total == 0.0:
        return 0.0, yaw_rate_radps
    lost = belt_yaw_rate - yaw_rate_radps
    return -0.5 * gauge_m * lost * (abs(right_mps) - abs(left_mps)) / total, -lost


class SlipEstimator:
    """Slip over one encoder period, from means over that same period.

    Not filtered over time: a low-pass would delay the very disturbance that the controller compensates.
    """

    def __init__(self, settings: SlipSettings) -> None:
        self._settings = settings

    def update(
        self,
        stamp_ns: int,
        left_mps: float,
        right_mps: float,
        yaw_rate_radps: float,
        yaw_rate_variance: float,
        duration_s: float,
    ) -> Slip:
        """Slip from mean belt speeds and mean bias-free yaw rate over the ``duration_s`` before ``stamp_ns``."""
        settings = self._settings
        if abs(left_mps) + abs(right_mps) < settings.standstill_track_speed_mps:
            return unknown_slip(stamp_ns)
        speed, yaw_rate = track_slip(left_mps, right_mps, yaw_rate_radps, settings.gauge_m)
        # A difference of two rounded counts has variance tick^2 / 6 per belt.
        belt_variance = settings.encoder_tick_m**2 / (6.0 * duration_s * duration_s)
        variance = yaw_rate_variance + 2.0 * belt_variance / settings.gauge_m**2
        share = (abs(right_mps) - abs(left_mps)) / (abs(right_mps) + abs(left_mps))
        return Slip(
            stamp_ns=stamp_ns,
            speed_mps=speed,
            yaw_rate_radps=yaw_rate,
            speed_variance=(0.5 * settings.gauge_m * share) ** 2 * variance + 0.5 * belt_variance,
            yaw_rate_variance=variance,
            known=True,
        )


def unknown_slip(stamp_ns: int) -> Slip:
    """Slip when nothing witnesses it: standstill, or a sensor fails."""
    return Slip(stamp_ns, 0.0, 0.0, 0.0, 0.0, known=False)


def slip_at(slip: Slip, instant_ns: int, longest_age_s: float) -> Slip:
    """``slip`` as it still holds at ``instant_ns``, or unknown slip if it is older than ``longest_age_s``."""
    if not 0.0 <= seconds_between(instant_ns, slip.stamp_ns) <= longest_age_s:
        return unknown_slip(instant_ns)
    return slip if slip.stamp_ns == instant_ns else replace(slip, stamp_ns=instant_ns)
