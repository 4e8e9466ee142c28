"""Settings of the navigator."""

from dataclasses import dataclass

from tracked_types import PLAN_RATE_HZ
from tracked_types.setting import check_settings, setting


@dataclass(frozen=True, slots=True, kw_only=True)
class NavigatorSettings:
    """When it plans anew, waits, gives up, and has arrived."""

    rate_hz: int = setting(PLAN_RATE_HZ, "bands per second: one for each plan of the upper layer", low=1, high=30)
    replan_period_s: float = setting(
        1.0, "time between two looks for a better global path", unit="s", low=0.1, high=60.0
    )
    replan_gain: float = setting(
        0.2, "share by which another global path must be cheaper before the robot takes it", low=0.0, high=1.0
    )
    view_m: float = setting(3.5, "obstacles farther from the robot are not for the band", unit="m", low=1.0, high=20.0)
    remember_s: float = setting(
        120.0, "what the map lacks is remembered so long unless it is seen to be gone", unit="s", low=0.0, high=1e5
    )
    scan_timeout_s: float = setting(0.4, "without a scan for this long the robot stops", unit="s", low=0.05, high=10.0)
    patience_s: float = setting(
        30.0, "without headway for this long the goal is given up", unit="s", low=1.0, high=3600.0
    )
    headway_m: float = setting(0.1, "way towards the goal that counts as headway", unit="m", low=0.01, high=5.0)
    tether_m: float = setting(
        0.04, "the next band begins no farther from the robot than this", unit="m", low=0.0, high=0.5
    )
    tether_rad: float = setting(0.08, "the same, of the heading", unit="rad", low=0.0, high=1.0)
    pass_m: float = setting(0.3, "how near it passes goals that are not the last", unit="m", low=0.05, high=5.0)
    reached_m: float = setting(0.03, "position error of a reached goal", unit="m", low=0.005, high=1.0)
    reached_rad: float = setting(0.04, "heading error of a reached goal", unit="rad", low=0.005, high=3.2)
    rest_speed_mps: float = setting(0.02, "forward speed that counts as rest", unit="m/s", low=0.0, high=1.0)
    rest_yaw_rate_radps: float = setting(0.05, "yaw rate that counts as rest", unit="rad/s", low=0.0, high=1.0)
    settle_s: float = setting(
        8.0, "time at the end of the way until it is driven to anew", unit="s", low=0.5, high=60.0
    )
    attempts: int = setting(3, "how often the end of the way is driven to", low=1, high=20)

    def __post_init__(self) -> None:
        check_settings(self)
