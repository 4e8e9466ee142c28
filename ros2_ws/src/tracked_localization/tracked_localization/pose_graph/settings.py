"""Settings of the closing of loops."""

from dataclasses import dataclass

from tracked_types.setting import check_settings, setting


@dataclass(frozen=True, slots=True, kw_only=True)
class LoopSettings:
    """Which scans are kept, where loops are looked for, and what counts as one."""

    key_distance_m: float = setting(0.3, "a scan is kept after so much driving", unit="m", low=0.05, high=10.0)
    key_turn_rad: float = setting(0.4, "a scan is kept after so much turning", unit="rad", low=0.05, high=3.0)
    recent_m: float = setting(
        12.0,
        "new scans are laid over what was seen within this way, or twice it, from here; the rest is met by loops alone",
        unit="m",
        low=1.0,
        high=1000.0,
    )
    loop_radius_m: float = setting(
        3.0, "loops are looked for among kept scans as near as this", unit="m", low=0.1, high=100.0
    )
    loop_share_m_per_m: float = setting(
        0.03, "the same, farther by this for every metre of the way between", low=0.0, high=1.0
    )
    loop_least_way_m: float = setting(
        12.0, "a way shorter than this between two kept scans is no loop", unit="m", low=1.0, high=1000.0
    )
    loop_agreement: float = setting(
        0.7, "share of a scan's points that must lie on the walls of the place it comes back to", low=0.1, high=1.0
    )
    loop_deviation_m: float = setting(
        0.06, "root mean square distance from those walls at most", unit="m", low=0.005, high=1.0
    )
    loop_confirmations: int = setting(
        3, "so many kept scans in a row must come back to the same place before a loop is one", low=1, high=20
    )
    loop_chi_square: float = setting(
        16.0,
        "squared misfit, in standard deviations, from which on a loop contradicts the rest and is refused",
        low=3.0,
    )
    match_floor_m: float = setting(
        0.02,
        "standard deviation of a matched motion that more points do not make smaller",
        unit="m",
        low=1e-3,
        high=1.0,
    )
    match_floor_rad: float = setting(0.006, "the same of its heading", unit="rad", low=1e-4, high=1.0)
    loop_floor_m: float = setting(
        0.05, "standard deviation of a loop that more points do not make smaller", unit="m", low=1e-3, high=1.0
    )
    loop_floor_rad: float = setting(0.015, "the same of its heading", unit="rad", low=1e-4, high=1.0)
    odometry_m_per_m: float = setting(
        0.15, "standard deviation of the odometry along directions that scans do not show", low=1e-3, high=2.0
    )
    odometry_rad_per_m: float = setting(0.05, "the same of its heading per metre", unit="rad/m", low=1e-4, high=2.0)

    def __post_init__(self) -> None:
        check_settings(self)
