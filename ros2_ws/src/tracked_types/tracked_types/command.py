"""Velocity command."""

from dataclasses import dataclass

from tracked_types.twist import Twist2


@dataclass(frozen=True, slots=True)
class VelocityCommand:
    """A twist asked of the base.

    ``stamp_ns`` is the stamp of the odometry the command answers, not the time of sending: the
    simulator and the delay compensation count the transport delay from it.
    """

    stamp_ns: int
    twist: Twist2
