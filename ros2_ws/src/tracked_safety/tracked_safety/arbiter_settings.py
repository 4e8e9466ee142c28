"""Settings of the command arbiter."""

from dataclasses import dataclass

from tracked_description import Robot
from tracked_safety.command_limits import CommandLimits
from tracked_types.setting import check_settings, setting

SOURCES = ("teleop", "follow", "nav")  # highest priority first


@dataclass(frozen=True, slots=True, kw_only=True)
class ArbiterSettings:
    """Limits, watchdog and rates; those of the robot come from robot.yaml."""

    limits: CommandLimits
    timeout_s: float
    rate_hz: int
    refuse_beyond: float = setting(
        1.5, "commands beyond this multiple of a limit are refused, smaller excess is cut off", low=1.0, high=100.0
    )

    def __post_init__(self) -> None:
        check_settings(self)

    @classmethod
    def from_robot(cls, robot: Robot, refuse_beyond: float = 1.5) -> "ArbiterSettings":
        """Settings for ``robot``; ``refuse_beyond`` is the tunable field."""
        return cls(
            limits=CommandLimits.from_robot(robot),
            timeout_s=robot.control.command_timeout_s,
            rate_hz=robot.control.rate_hz,
            refuse_beyond=refuse_beyond,
        )
