"""Settings of the command arbiter."""

from dataclasses import dataclass

from tracked_description import Robot
from tracked_safety.command_limits import CommandLimits
from tracked_types.setting import check_settings, setting

SOURCES = ("teleop", "follow", "nav")  # highest priority first
ATTENDED = ("teleop",)  # a person steers


@dataclass(frozen=True, slots=True, kw_only=True)
class ArbiterSettings:
    """Limits, watchdog and rates; those of the robot come from robot.yaml.

    track_braking_mps2: the hardest that a belt can brake, for obstacles that appear too near for anything gentler.
    """

    limits: CommandLimits
    track_braking_mps2: float
    timeout_s: float
    rate_hz: int
    refuse_beyond: float = setting(
        1.5, "commands beyond this multiple of a limit are refused, smaller excess is cut off", low=1.0, high=100.0
    )
    jerk_mps3: float = setting(
        10.0, "how fast teleoperation may change its acceleration while speeding up; 0: at once", unit="m/s^3", low=0.0
    )
    yaw_jerk_radps3: float = setting(40.0, "the same of turns", unit="rad/s^3", low=0.0)

    def __post_init__(self) -> None:
        check_settings(self)

    @classmethod
    def from_robot(cls, robot: Robot, **tuning: float) -> "ArbiterSettings":
        """Settings for ``robot``; ``tuning`` are values of the tunable fields."""
        return cls(
            limits=CommandLimits.from_robot(robot),
            track_braking_mps2=robot.tracks.acceleration_limit_mps2,
            timeout_s=robot.control.command_timeout_s,
            rate_hz=robot.control.rate_hz,
            **tuning,
        )
