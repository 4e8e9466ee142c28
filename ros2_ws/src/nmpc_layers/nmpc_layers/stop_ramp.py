"""Commands for when there is no solution to drive."""

from nmpc_layers.drive_limits import DriveLimits
from tracked_types import Twist2


class StopRamp:
    """Holds the last good command for a moment, then brakes within the limits to standstill.

    Parameters
    ----------
    limits: of the base.
    period_s: time between commands.
    hold_s: how long the last good command is repeated before braking begins.
    """

    def __init__(self, limits: DriveLimits, period_s: float, hold_s: float) -> None:
        self._limits, self._period_s, self._hold_s = limits, period_s, hold_s
        self._last = Twist2(0.0, 0.0)
        self._held_s = 0.0

    def accept(self, twist: Twist2) -> None:
        """A good command was driven; the ramp starts from it when the next is missing."""
        self._last, self._held_s = twist, 0.0

    def next(self) -> Twist2:
        """Command of a tick without a solution."""
        if self._held_s + self._period_s <= self._hold_s + 1e-9:
            self._held_s += self._period_s
        else:
            self._last = self._limits.braked(self._last, self._period_s)
        return self._last
