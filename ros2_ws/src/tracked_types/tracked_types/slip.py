"""Slip of a track pair."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Slip:
    """What the ground adds to the motion that the belts ask for.

    Ground speed = belt speed + ``speed_mps``; ground yaw rate = belt yaw rate + ``yaw_rate_radps``
    (delta v and delta omega of (5.2.8)-(5.2.11) in ratio-free form). ``known`` is False at standstill,
    where the tracks bear no witness; the numbers are then zero. ``speed_measured``: measured poses show the
    forward part, and odometry accounts for it; otherwise it is the assumption (5.2.8), which odometry does not share.
    ``slide_s``: tracks slide outwards in curves, by this angle (rad) between motion and heading per yaw rate (rad/s);
    it holds at standstill too.
    """

    stamp_ns: int
    speed_mps: float
    yaw_rate_radps: float
    speed_variance: float
    yaw_rate_variance: float
    known: bool
    speed_measured: bool = False
    slide_s: float = 0.0
