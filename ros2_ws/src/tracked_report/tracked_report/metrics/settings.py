"""What the figures of a run mean."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class MetricSettings:
    """Definitions that are choices, not physics.

    tail_s: how long after the reference has come to rest errors still count; later, the robot only waits.
    settled_position_m, settled_yaw_rad: errors within which the robot counts as settled at the end.
    recovered_position_m, recovered_yaw_rad, recovered_hold_s: errors within which the robot must stay for this long to
        have recovered from a sudden change of its pose (5.3.2).
    low_pass_hz: of the vertical acceleration, as the thesis's comparison is made.
    """

    tail_s: float = 1.0
    settled_position_m: float = 0.05
    settled_yaw_rad: float = 0.1
    recovered_position_m: float = 0.03
    recovered_yaw_rad: float = 0.05
    recovered_hold_s: float = 0.5
    low_pass_hz: float = 50.0
