import math

import numpy as np
import pytest

from tracked_bringup.live_state import LiveState
from tracked_types import GoalReached, Odometry, Pose2, Slip, SolverStatus, Trajectory, Twist2


def odometry(stamp_ns: int, x: float, y: float) -> Odometry:
    return Odometry(stamp_ns, "odom", "base", Pose2(x, y, 0.0), Twist2(0.0, 0.0), np.eye(3), np.eye(2))


def test_an_empty_state_can_be_shown() -> None:
    line = LiveState().line("double", 0.0, 30.0)
    assert "double" in line and "nan" not in line


def test_tracking_error_is_taken_at_the_stamp_of_the_odometry() -> None:
    state = LiveState()
    states = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]])
    state.note_reference(Trajectory(0, "odom", np.array([0.0, 1.0]), states, np.zeros((2, 2))))
    assert math.isnan(state.tracking_error_m)
    state.note_odometry(odometry(500_000_000, 0.5, 0.03))
    assert state.tracking_error_m == pytest.approx(0.03)


def test_real_time_factor_is_that_of_the_last_seconds() -> None:
    state = LiveState()
    assert math.isnan(state.real_time_factor(0.0))
    factors = []
    for step in range(100):
        state.note_time(round(step * 0.1 * (1.0 if step < 50 else 2.0) * 1e9))
        factors.append(state.real_time_factor(step * 0.1))
    assert factors[40] == pytest.approx(1.0) and factors[-1] == pytest.approx(2.0)


def test_the_line_shows_what_is_known() -> None:
    state = LiveState()
    state.note_odometry(odometry(2_000_000_000, 0.0, 0.0))
    state.note_slip(Slip(0, -0.02, 0.31, 1e-4, 1e-4, True))
    state.note_status(SolverStatus(0, "upper", True, "", 4, 1.0, 0.0001))
    state.note_status(SolverStatus(0, "lower", False, "late plan", 4, 1.0, 0.0002))
    state.note_goal(GoalReached(0, "line", 0.0, 0.0))
    line = state.line("double", 0.0, 30.0)
    for words in ("2.0/30 s", "-0.020 m/s +0.31 rad/s", "lower 0.20 upper 0.10 ms", "lower: late plan", "goal reached"):
        assert words in line


def test_slip_at_standstill_is_not_shown_as_zero() -> None:
    state = LiveState()
    state.note_slip(Slip(0, 0.0, 0.0, 1.0, 1.0, False))
    assert "0.000 m/s" not in state.line("double", 0.0, 30.0)
