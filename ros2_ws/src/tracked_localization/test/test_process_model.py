import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tracked_localization.constant_twist import constant_twist_step
from tracked_localization.process_model import transition, unseen_motion
from tracked_localization.state import ACCELERATION, BIAS, SHARE, SIZE, YAW

DT = 1.0 / 120.0


def test_acceleration_reaches_the_pose_by_way_of_the_speeds():
    step = constant_twist_step(0.3, 0.4, 0.5, DT)
    change = transition(step, DT, 1.0, 0.4, 0.0, learning=True) @ np.eye(SIZE)[ACCELERATION]
    assert change[:2] == pytest.approx([step.x_per_speed * DT, step.y_per_speed * DT])
    assert change[3] == pytest.approx(DT)
    assert change[6] == pytest.approx(DT * DT)
    assert 0.0 < change[7] < 1.0


@given(st.floats(-3.0, 3.0), st.floats(-0.7, 0.7), st.floats(-2.0, 2.0), st.floats(-0.5, 0.9))
def test_a_share_lost_to_the_ground_moves_the_pose_less(heading, belts, rate, lost):
    def place(share):
        step = constant_twist_step(heading, (1.0 - share) * belts, rate, DT)
        return np.array([step.x_m, step.y_m])

    step = constant_twist_step(heading, (1.0 - lost) * belts, rate, DT)
    slope = transition(step, DT, 1.0, belts, lost, learning=True)[:2, SHARE]
    assert slope == pytest.approx((place(lost + 1e-6) - place(lost - 1e-6)) / 2e-6, abs=1e-9)


@given(st.floats(-4.0, 4.0), st.floats(-1.0, 1.0), st.floats(-3.0, 3.0), st.booleans())
def test_unseen_motion_is_a_covariance(settings, heading, speed, rate, gyro_fails):
    noise = unseen_motion(settings, heading, speed, rate, DT, gyro_fails=gyro_fails)
    assert noise.shape == (SIZE, SIZE)
    assert np.array_equal(noise, noise.T)
    assert np.linalg.eigvalsh(noise).min() > -1e-15


def test_standing_robot_slips_nowhere(settings):
    noise = unseen_motion(settings, 1.0, 0.0, 0.0, DT, gyro_fails=True)
    noise[BIAS, BIAS] = 0.0
    assert not noise.any()


def test_heading_slips_with_the_belts_only_without_gyro(settings):
    assert unseen_motion(settings, 0.0, 0.3, 0.5, DT, gyro_fails=True)[YAW, YAW] > 0.0
    assert unseen_motion(settings, 0.0, 0.3, 0.5, DT, gyro_fails=False)[YAW, YAW] == 0.0
