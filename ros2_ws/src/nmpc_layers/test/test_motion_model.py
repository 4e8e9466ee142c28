import casadi
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from nmpc_layers.sent_commands import GroundModel, predict
from nmpc_layers.solver.motion_model import PARAMETER_COUNT, Motion, MotionParameters, next_state
from tracked_types import Pose2, Twist2, wrap_angle


@pytest.fixture(scope="module")
def step():
    def build(motion):
        state, command = casadi.SX.sym("state", motion.state_count), casadi.SX.sym("command", 2)
        parameters = casadi.SX.sym("parameters", PARAMETER_COUNT)
        following = next_state(motion, state, command, parameters)
        function = casadi.Function("step", [state, command, parameters], [following])
        return lambda x, u, p: function(x, u, p.as_array()).full().ravel()

    return {motion: build(motion) for motion in Motion}


def test_state_is_kept_and_the_increment_added(step):
    moved = step[Motion.KINEMATIC]([3.0, 4.0, 0.0], [0.5, 0.0], MotionParameters(period_s=0.2))
    assert moved == pytest.approx([3.1, 4.0, 0.0])


def test_printed_rule_takes_the_heading_at_the_start(step):
    printed = MotionParameters(period_s=0.2, heading_point=0.0)
    assert step[Motion.KINEMATIC]([0.0, 0.0, 0.0], [0.5, 1.3], printed)[1] == 0.0


def test_midpoint_rule_follows_the_arc_an_order_closer(step):
    speed, rate, period = 0.5, 1.3, 0.2
    arc = speed / rate * np.array([np.sin(rate * period), 1.0 - np.cos(rate * period)])

    def error(heading_point):
        parameters = MotionParameters(period_s=period, heading_point=heading_point)
        return np.linalg.norm(step[Motion.KINEMATIC]([0.0, 0.0, 0.0], [speed, rate], parameters)[:2] - arc)

    assert error(0.5) < 0.03 * error(0.0)


def test_slip_adds_to_the_motion_of_the_belts(step):
    parameters = MotionParameters(period_s=0.1, speed_slip_mps=-0.1, yaw_slip_radps=0.2, yaw_efficiency=0.5)
    assert step[Motion.KINEMATIC]([0.0, 0.0, 0.0], [0.1, 1.0], parameters) == pytest.approx([0.0, 0.0, 0.07])


def test_slide_takes_the_motion_outwards_off_the_heading(step):
    parameters = MotionParameters(period_s=0.1, heading_point=0.0, slide_s=0.2)
    moved = step[Motion.KINEMATIC]([0.0, 0.0, 0.0], [0.5, 1.0], parameters)
    assert moved == pytest.approx([0.05 * np.cos(0.2), -0.05 * np.sin(0.2), 0.1])


def test_lag_is_the_exact_response_to_a_held_command(step):
    whole = MotionParameters(period_s=0.1, lag_s=0.06)
    parts = MotionParameters(period_s=0.1 / 500, lag_s=0.06)
    fine = np.array([0.0, 0.0, 0.3, 0.2, -0.4])
    for _ in range(500):
        fine = step[Motion.LAG](fine, [0.5, 0.6], parts)
    coarse = step[Motion.LAG]([0.0, 0.0, 0.3, 0.2, -0.4], [0.5, 0.6], whole)
    assert coarse[2:] == pytest.approx(fine[2:], abs=1e-9)
    assert coarse[:2] == pytest.approx(fine[:2], abs=3e-4)


@settings(max_examples=50, derandomize=True, deadline=None)
@given(
    yaw=st.floats(-3.1, 3.1),
    belts=st.tuples(st.floats(-0.5, 0.5), st.floats(-1.3, 1.3)),
    command=st.tuples(st.floats(-0.5, 0.5), st.floats(-1.3, 1.3)),
    slip=st.tuples(st.floats(-0.1, 0.1), st.floats(-1, 1)),
    slide_s=st.floats(0.0, 0.3),
)
def test_delay_compensation_predicts_with_the_same_law(step, yaw, belts, command, slip, slide_s):
    parameters = MotionParameters(
        period_s=0.04,
        speed_slip_mps=slip[0],
        yaw_slip_radps=slip[1],
        yaw_efficiency=0.8,
        lag_s=0.06,
        slide_s=slide_s,
    )
    expected = step[Motion.LAG]([1.0, 2.0, yaw, *belts], command, parameters)
    ground = GroundModel(
        speed_slip_mps=slip[0], yaw_slip_radps=slip[1], yaw_efficiency=0.8, lag_s=0.06, slide_s=slide_s
    )
    pose, twist = predict(Pose2(1.0, 2.0, yaw), Twist2(*belts), iter([(0.04, Twist2(*command))]), ground)
    expected[2] = wrap_angle(float(expected[2]))
    assert [pose.x_m, pose.y_m, pose.yaw_rad] == pytest.approx(expected[:3], abs=1e-12)
    assert [twist.speed_mps, twist.yaw_rate_radps] == pytest.approx(expected[3:], abs=1e-12)
