"""From keys to a twist."""

from dataclasses import dataclass
from typing import Any

from tracked_description import Robot
from tracked_safety.command_limits import CommandLimits
from tracked_safety.teleop.held_command import HeldCommand
from tracked_types import Twist2
from tracked_types.setting import check_settings, setting

MOTIONS: dict[str, tuple[int, int]] = {
    **dict.fromkeys(("up", "w", "i"), (1, 0)),
    **dict.fromkeys(("down", "s", ","), (-1, 0)),
    **dict.fromkeys(("left", "a", "j"), (0, 1)),
    **dict.fromkeys(("right", "d", "l"), (0, -1)),
    "u": (1, 1),
    "o": (1, -1),
    "m": (-1, -1),
    ".": (-1, 1),
}
"""Key -> share of the speed and of the yaw rate; back to the left turns as a car would."""
FASTER, SLOWER, SHARPER, WIDER = ("+", "="), ("-",), ("]",), ("[",)
HELP = """\
  drive   arrows, or w a s d, or i j l ,    arcs  u o m .
  speed   + - both     [ ] turns only
  stop    space or k, and any other key; it is kept up until the next drive key
A key counts while the terminal repeats it. Ctrl-C ends."""


@dataclass(frozen=True, slots=True, kw_only=True)
class KeySettings:
    """Speeds at first, and how long a key counts."""

    limits: CommandLimits

    speed_mps: float = setting(0.25, "speed at first", unit="m/s", low=0.0, high=5.0)
    yaw_rate_radps: float = setting(0.6, "yaw rate at first", unit="rad/s", low=0.0, high=10.0)
    speed_step: float = setting(1.1, "factor of one press of a speed key", low=1.0, high=2.0)
    hold_s: float = setting(
        0.15, "a key counts for this long after the terminal has told it", unit="s", low=0.05, high=0.2
    )
    first_hold_s: float = setting(
        0.15,
        "the same of a first press: terminals repeat a held key only after half a second, which 0.6 would bridge, "
        "but then a mere tap drives for that long",
        unit="s",
        low=0.05,
        high=1.0,
    )
    rest_s: float = setting(
        0.5, "how long rest is commanded after that, before others may take over", unit="s", low=0.2, high=60.0
    )

    def __post_init__(self) -> None:
        check_settings(self)

    @classmethod
    def from_robot(cls, robot: Robot, **tuning: Any) -> "KeySettings":
        """Settings for ``robot``; ``tuning`` are values of the tunable fields."""
        return cls(limits=CommandLimits.from_robot(robot), **tuning)


class KeyTeleop:
    """Takes keys by name as they come, and gives what they ask for; a key is a letter or an arrow's direction."""

    def __init__(self, settings: KeySettings) -> None:
        self._settings = settings
        self._held = HeldCommand(settings.rest_s)
        self._key = ""
        self._scale_to(settings.speed_mps, settings.yaw_rate_radps)

    @property
    def speeds(self) -> Twist2:
        """Speed and yaw rate that a key asks for."""
        return Twist2(self._speed_mps, self._yaw_rate_radps)

    def press(self, key: str, now_s: float) -> None:
        """A key is told at ``now_s``; one that means nothing stops the robot, as any key should in a fright."""
        step = self._settings.speed_step
        if key in MOTIONS:
            self._drive(key, now_s)
        elif key in FASTER:
            self._scale_to(self._speed_mps * step, self._yaw_rate_radps * step)
        elif key in SLOWER:
            self._scale_to(self._speed_mps / step, self._yaw_rate_radps / step)
        elif key in SHARPER:
            self._scale_to(self._speed_mps, self._yaw_rate_radps * step)
        elif key in WIDER:
            self._scale_to(self._speed_mps, self._yaw_rate_radps / step)
        else:
            self._held.stop(now_s, for_good=True)

    def twist(self, now_s: float) -> Twist2 | None:
        """What is asked for now; None: nothing, others may command."""
        return self._held.at(now_s)

    def _drive(self, key: str, now_s: float) -> None:
        settings = self._settings
        is_repeated = key == self._key and self._held.is_held(now_s)
        self._key = key
        ahead, left = MOTIONS[key]
        twist = settings.limits.clamped(Twist2(ahead * self._speed_mps, left * self._yaw_rate_radps))
        self._held.hold(twist, now_s + (settings.hold_s if is_repeated else settings.first_hold_s))

    def _scale_to(self, speed_mps: float, yaw_rate_radps: float) -> None:
        limits = self._settings.limits
        self._speed_mps = min(speed_mps, limits.speed_max_mps)
        self._yaw_rate_radps = min(yaw_rate_radps, limits.yaw_rate_max_radps)
