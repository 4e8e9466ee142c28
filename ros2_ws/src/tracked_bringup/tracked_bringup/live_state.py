"""What the live status line knows of a run. No ROS."""

import math
from collections import deque

import numpy as np

from tracked_types import GoalReached, Odometry, Slip, SolverStatus, Trajectory

_RATE_WINDOW_S = 3.0


class LiveState:
    """Newest values of a run, and the line that shows them."""

    def __init__(self) -> None:
        self.stamp_ns: int | None = None
        self.goal: GoalReached | None = None
        self.odometry: Odometry | None = None
        self._reference: Trajectory | None = None
        self._slip: Slip | None = None
        self._solver_s: dict[str, float] = {}
        self._trouble = ""
        self._paces: deque[tuple[float, int]] = deque()

    def note_time(self, stamp_ns: int) -> None:
        """Simulated time."""
        self.stamp_ns = stamp_ns

    def note_odometry(self, odometry: Odometry) -> None:
        """Newest odometry; also the time where there is no simulator."""
        self.odometry = odometry
        self.stamp_ns = max(self.stamp_ns or 0, odometry.stamp_ns)

    def note_reference(self, reference: Trajectory) -> None:
        """Newest piece of reference."""
        self._reference = reference

    def note_slip(self, slip: Slip) -> None:
        """Newest slip."""
        self._slip = slip

    def note_goal(self, goal: GoalReached) -> None:
        """The robot has arrived."""
        self.goal = goal

    def note_status(self, status: SolverStatus) -> None:
        """Newest outcome of one layer."""
        self._solver_s[status.layer] = status.cpu_time_s
        self._trouble = "" if status.ok else f"{status.layer}: {status.reason}"

    @property
    def time_s(self) -> float:
        """Simulated time, 0 while unknown."""
        return (self.stamp_ns or 0) * 1e-9

    @property
    def tracking_error_m(self) -> float:
        """Distance between odometry and reference at its stamp; NaN while one is unknown."""
        if self.odometry is None or self._reference is None:
            return math.nan
        states, _ = self._reference.at(self.odometry.stamp_ns, np.zeros(1))
        return float(math.hypot(states[0, 0] - self.odometry.pose.x_m, states[0, 1] - self.odometry.pose.y_m))

    def real_time_factor(self, now_s: float) -> float:
        """Simulated over wall time of the last seconds; ``now_s`` is of a steady clock. NaN at first."""
        if self.stamp_ns is None:
            return math.nan
        self._paces.append((now_s, self.stamp_ns))
        while now_s - self._paces[0][0] > _RATE_WINDOW_S:
            self._paces.popleft()
        wall_s, stamp_ns = self._paces[0]
        return (self.stamp_ns - stamp_ns) * 1e-9 / (now_s - wall_s) if now_s > wall_s else math.nan

    def line(self, label: str, now_s: float, end_s: float) -> str:
        """One line: simulated time, real-time factor, tracking error, slip, solver times."""
        parts = [
            f"{label}  {self.time_s:5.1f}/{end_s:.0f} s",
            f"real time x{_number(self.real_time_factor(now_s), '.2f')}",
        ]
        parts.append(f"error {_number(self.tracking_error_m * 1000.0, '4.0f')} mm")
        if self._slip is not None and self._slip.known:
            parts.append(f"slip {self._slip.speed_mps:+.3f} m/s {self._slip.yaw_rate_radps:+.2f} rad/s")
        else:
            parts.append("slip    -")
        solvers = " ".join(f"{layer} {cpu_s * 1000.0:.2f}" for layer, cpu_s in sorted(self._solver_s.items()))
        parts.append(f"solver {solvers or '-'} ms")
        if self._trouble:
            parts.append(self._trouble)
        if self.goal is not None:
            parts.append("goal reached")
        return "  ".join(parts)


def _number(value: float, form: str) -> str:
    return format(value, form) if math.isfinite(value) else "-"
