"""Plans on their way through the pipeline."""

from collections import deque
from dataclasses import dataclass

from tracked_types import Trajectory, Twist2


@dataclass(frozen=True, slots=True)
class Plan:
    """A plan and when it takes effect.

    twist: its first command; None where there is no solution and the trajectory only brings the robot to rest.
    """

    effective_ns: int
    trajectory: Trajectory
    twist: Twist2 | None


class PlanQueue:
    """Holds plans back until they take effect: what the pipeline's processing time would do."""

    def __init__(self) -> None:
        self._waiting: deque[Plan] = deque()
        self.effective: Plan | None = None

    def add(self, plan: Plan) -> None:
        """A plan just made; plans take effect in the order in which they are made."""
        self._waiting.append(plan)

    def release(self, stamp_ns: int) -> Trajectory | None:
        """The newest plan that has taken effect by ``stamp_ns`` and was not released before."""
        released = None
        while self._waiting and self._waiting[0].effective_ns <= stamp_ns:
            self.effective = released = self._waiting.popleft()
        return released.trajectory if released else None
