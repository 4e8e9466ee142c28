"""A command that holds only as long as somebody keeps it up."""

import math

from tracked_types import Twist2

_REST = Twist2(0.0, 0.0)


class HeldCommand:
    """A twist while it is held, then rest for ``rest_s``, then nothing: whoever commands besides may take over.

    Times are seconds of any clock that does not go back.
    """

    def __init__(self, rest_s: float) -> None:
        self._rest_s = rest_s
        self._twist = _REST
        self._held_until_s = -math.inf
        self._rest_until_s = -math.inf

    def hold(self, twist: Twist2, until_s: float) -> None:
        """Ask for ``twist`` until then, unless it is held anew."""
        self._twist, self._held_until_s = twist, until_s
        self._rest_until_s = until_s + self._rest_s

    def stop(self, now_s: float, *, for_good: bool = False) -> None:
        """Ask for rest at once; for good: until the next `hold`."""
        self._held_until_s = -math.inf
        self._rest_until_s = math.inf if for_good else now_s + self._rest_s

    def is_held(self, now_s: float) -> bool:
        """Whether somebody keeps it up."""
        return now_s < self._held_until_s

    def at(self, now_s: float) -> Twist2 | None:
        """What is asked for now."""
        if self.is_held(now_s):
            return self._twist
        return _REST if now_s < self._rest_until_s else None
