"""The last algorithm before the base: which command passes, within which limits, and when the robot stops."""

from tracked_safety.arbiter_settings import SOURCES, ArbiterSettings
from tracked_safety.command_arbiter import CommandArbiter, CommandRefused
from tracked_safety.command_limits import CommandLimits

__all__ = ["SOURCES", "ArbiterSettings", "CommandArbiter", "CommandLimits", "CommandRefused"]
