"""Settings of the timed elastic band."""

from dataclasses import dataclass

from tracked_description import Footprint, Robot
from tracked_navigation.motion_limits import MotionLimits
from tracked_types.setting import check_settings, setting


@dataclass(frozen=True, slots=True, kw_only=True)
class BandSettings:
    """What the robot covers and can do, and what may be tuned.

    limits: what a trajectory may ask of the base; controllers need the rest.
    """

    footprint: Footprint
    limits: MotionLimits

    frame_id: str = setting("map", "frame of start, path, obstacles and movers, and of the trajectory")
    speed_mps: float = setting(0.4, "largest speed ahead", unit="m/s", low=0.02, high=5.0)
    reverse_mps: float = setting(0.15, "largest speed backwards", unit="m/s", low=0.0, high=2.0)
    lookahead_m: float = setting(2.5, "length of path that the band spans", unit="m", low=0.5, high=10.0)
    clearance_m: float = setting(0.10, "room that is wanted around the robot", unit="m", low=0.0, high=2.0)
    least_clearance_m: float = setting(
        0.02, "room without which no trajectory is handed out", unit="m", low=0.001, high=0.5
    )
    mover_clearance_m: float = setting(0.20, "room that is wanted beside a mover", unit="m", low=0.0, high=2.0)
    mover_growth_mps: float = setting(
        0.05, "wanted room beside a mover grows with the time until then", unit="m/s", low=0.0, high=1.0
    )
    switch_gain: float = setting(
        0.15, "share by which another way round must be cheaper before the band changes over", low=0.0, high=1.0
    )
    goal_tolerance_m: float = setting(0.02, "how far from the goal a trajectory may end", unit="m", low=0.001, high=0.5)
    goal_tolerance_rad: float = setting(
        0.03, "by how much a trajectory may miss the goal's heading", unit="rad", low=0.001, high=1.0
    )
    compile_solver: bool = setting(True, "compile the band's functions with the system's C compiler")

    def __post_init__(self) -> None:
        check_settings(self)
        if self.least_clearance_m > self.clearance_m:
            raise ValueError(
                f"BandSettings.least_clearance_m must not exceed clearance_m of {self.clearance_m:g} m, "
                f"got {self.least_clearance_m!r}"
            )

    @classmethod
    def from_robot(cls, robot: Robot, *, limit_share: float = 0.85, **tuning: float | bool | str) -> "BandSettings":
        """Settings for ``robot``; a trajectory asks no more than ``limit_share`` of its limits.

        ``tuning`` are values of the tunable fields.
        """
        return cls(
            footprint=Footprint.from_robot(robot),
            limits=MotionLimits.from_robot(robot, limit_share),
            **tuning,  # type: ignore[arg-type]
        )

    @property
    def cruise_mps(self) -> float:
        """Largest speed ahead within the limits."""
        return min(self.speed_mps, self.limits.speed_max_mps)
