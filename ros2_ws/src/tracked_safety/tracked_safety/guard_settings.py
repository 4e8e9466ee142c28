"""Settings of the collision guard."""

from dataclasses import dataclass

from tracked_description import Footprint, Robot
from tracked_types import Pose2
from tracked_types.setting import check_settings, setting

_LEVEL_RAD = 0.1


@dataclass(frozen=True, slots=True, kw_only=True)
class GuardSettings:
    """How the robot brakes, where its lidar is, and how much room it keeps.

    delay_s: from a command's stamp until the belts have its speed, on average. lidar: mounting in the base's frame.
    """

    footprint: Footprint
    braking_mps2: float
    delay_s: float
    lidar: Pose2

    margin_m: float = setting(0.06, "room that is kept around the robot at speed", unit="m", low=0.0, high=1.0)
    tight_margin_m: float = setting(0.02, "room that is kept at a crawl", unit="m", low=0.0, high=1.0)
    crawl_mps: float = setting(
        0.08, "speed at which the robot may go on where the margin is used up", unit="m/s", low=0.0, high=0.5
    )
    approach_s: float = setting(
        1.0, "what lies ahead is kept this far away in time; 0: only brake", unit="s", low=0.0, high=10.0
    )
    reaction_s: float = setting(0.1, "time until the next scan has been looked at", unit="s", low=0.0, high=2.0)
    scan_timeout_s: float = setting(
        0.3, "a scan whose last beam is older than this is none, and the robot stops", unit="s", low=0.05, high=5.0
    )
    scan_lost_s: float = setting(
        2.0,
        "when scans stay away for this long while somebody commands, the stop is latched; 0: never",
        unit="s",
        low=0.0,
        high=3600.0,
    )
    least_measured: float = setting(
        0.5, "a scan with a smaller share of beams that say anything is refused", low=0.0, high=1.0
    )

    def __post_init__(self) -> None:
        check_settings(self)

    @classmethod
    def from_robot(cls, robot: Robot, **tuning: float) -> "GuardSettings":
        """Settings for ``robot``; ``tuning`` are values of the tunable fields.

        Raises
        ------
        ValueError: if a value is out of range, or the lidar does not look around in a level plane.
        """
        roll, pitch, yaw = robot.lidar.rpy_rad
        if max(abs(roll), abs(pitch)) > _LEVEL_RAD:
            raise ValueError(f"the collision guard needs a level lidar; roll is {roll:g} rad, pitch {pitch:g} rad")
        return cls(
            footprint=Footprint.from_robot(robot),
            braking_mps2=robot.limits.braking_mps2,
            delay_s=robot.control.transport_delay_s + robot.tracks.motor_time_constant_s,
            lidar=Pose2(robot.lidar.xyz_m[0], robot.lidar.xyz_m[1], yaw),
            **tuning,
        )
