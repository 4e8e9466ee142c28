"""From a joystick to a twist."""

from dataclasses import dataclass
from typing import Any

from tracked_description import Robot
from tracked_safety.command_limits import CommandLimits
from tracked_safety.teleop.held_command import HeldCommand
from tracked_types import Joystick, StampOrder, Twist2, to_nanoseconds
from tracked_types.setting import check_settings, setting


class JoystickRefused(ValueError):
    """A message of the joystick cannot be used; ``reason`` is its class, for counting."""

    def __init__(self, reason: str) -> None:
        super().__init__(reason)
        self.reason = reason


@dataclass(frozen=True, slots=True, kw_only=True)
class JoySettings:
    """Which controls drive, how fast, and how long a message counts."""

    limits: CommandLimits

    axis_linear: int = setting(1, "axis of the speed", low=0, high=255)
    axis_angular: int = setting(0, "axis of the yaw rate", low=0, high=255)
    enable_button: int = setting(4, "dead-man's button: without it the robot stands", low=0, high=255)
    enable_turbo_button: int = setting(5, "dead-man's button for turbo; -1: none", low=-1, high=255)
    scale_linear_mps: float = setting(0.25, "speed at the end of the axis; negative: other way", unit="m/s")
    scale_angular_radps: float = setting(0.6, "yaw rate at the end of the axis; negative: other way", unit="rad/s")
    turbo_linear_mps: float = setting(0.5, "the same with turbo", unit="m/s")
    turbo_angular_radps: float = setting(1.2, "the same with turbo", unit="rad/s")
    dead_zone: float = setting(0.05, "share of an axis around its middle that counts as the middle", low=0.0, high=0.9)
    hold_s: float = setting(0.15, "a message counts for this long", unit="s", low=0.05, high=0.2)
    rest_s: float = setting(
        0.5, "how long rest is commanded after that, before others may take over", unit="s", low=0.2, high=60.0
    )

    def __post_init__(self) -> None:
        check_settings(self)

    @classmethod
    def from_robot(cls, robot: Robot, **tuning: Any) -> "JoySettings":
        """Settings for ``robot``; ``tuning`` are values of the tunable fields."""
        return cls(limits=CommandLimits.from_robot(robot), **tuning)


class JoyTeleop:
    """Takes messages of a joystick, and gives what they ask for."""

    def __init__(self, settings: JoySettings) -> None:
        self._settings = settings
        self._held = HeldCommand(settings.rest_s)
        self._order = StampOrder()
        self._hold_ns = to_nanoseconds(settings.hold_s)

    def update(self, joystick: Joystick, clock_ns: int, now_s: float) -> None:
        """Take a message in that came at ``now_s``; ``clock_ns`` is what its stamp is held against.

        Raises
        ------
        JoystickRefused: if it lacks a control or is out of time; it keeps nothing up.
        """
        settings = self._settings
        axes, buttons = joystick.axes, joystick.buttons
        needed = max(settings.axis_linear, settings.axis_angular)
        if len(axes) <= needed:
            raise JoystickRefused(f"{len(axes)} axes, there is no axis {needed}")
        needed = max(settings.enable_button, settings.enable_turbo_button)
        if len(buttons) <= needed:
            raise JoystickRefused(f"{len(buttons)} buttons, there is no button {needed}")
        if joystick.stamp_ns < clock_ns - self._hold_ns:
            raise JoystickRefused("stale stamp")
        if joystick.stamp_ns > clock_ns + self._hold_ns:
            raise JoystickRefused("stamp in the future")
        if not self._order.advance(joystick.stamp_ns):
            raise JoystickRefused("stamp repeated or out of order")
        turbo = settings.enable_turbo_button >= 0 and buttons[settings.enable_turbo_button]
        if turbo:
            speed_mps, yaw_rate_radps = settings.turbo_linear_mps, settings.turbo_angular_radps
        elif buttons[settings.enable_button]:
            speed_mps, yaw_rate_radps = settings.scale_linear_mps, settings.scale_angular_radps
        else:
            if self._held.is_held(now_s):
                self._held.stop(now_s)
            return
        twist = Twist2(
            speed_mps * self._position(axes[settings.axis_linear]),
            yaw_rate_radps * self._position(axes[settings.axis_angular]),
        )
        self._held.hold(settings.limits.clamped(twist), now_s + settings.hold_s)

    def twist(self, now_s: float) -> Twist2 | None:
        """What is asked for now; None: nothing, others may command."""
        return self._held.at(now_s)

    def _position(self, axis: float) -> float:
        """Position of an axis, from zero at the edge of the dead zone to one at its end."""
        dead = self._settings.dead_zone
        beyond = min(max(abs(axis) - dead, 0.0) / (1.0 - dead), 1.0)
        return beyond if axis > 0.0 else -beyond
