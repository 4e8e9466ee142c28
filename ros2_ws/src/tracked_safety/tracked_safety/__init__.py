"""The last algorithm before the base: which command passes, within which limits, and when the robot stops."""

from tracked_safety.arbiter_settings import SOURCES, ArbiterSettings
from tracked_safety.collision_guard import CollisionGuard, Permitted
from tracked_safety.command_arbiter import CommandArbiter
from tracked_safety.command_limits import CommandLimits
from tracked_safety.guard_settings import GuardSettings
from tracked_safety.scan_view import ScanRefused
from tracked_safety.source_roster import CommandRefused

__all__ = [
    "SOURCES",
    "ArbiterSettings",
    "CollisionGuard",
    "CommandArbiter",
    "CommandLimits",
    "CommandRefused",
    "GuardSettings",
    "Permitted",
    "ScanRefused",
]
