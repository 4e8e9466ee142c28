import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tracked_localization.pose_filter import PoseFilter
from tracked_localization.settings import OdometryFilterSettings
from tracked_localization.state import BIAS
from tracked_types import Pose2

DT = 1.0 / 120.0
FINITE = st.floats(-1e9, 1e9)
STEPS = st.one_of(
    st.tuples(st.just("predict"), st.floats(1e-9, 0.2), st.booleans(), st.booleans()),
    st.tuples(st.just("stand"), st.floats(1e-9, 0.2)),
    st.tuples(st.just("halt"), st.floats(1e-9, 0.2)),
    st.tuples(st.just("gyro"), FINITE, st.booleans()),
    st.tuples(st.just("rolled"), FINITE, st.floats(0.0, 1e6)),
    st.tuples(st.just("belt yaw"), FINITE, st.floats(1e-9, 1e6)),
    st.tuples(st.just("rebase")),
    st.tuples(st.just("doubt")),
    st.tuples(st.just("interrupt"), st.floats(0.0, 1e6)),
)


@pytest.fixture
def pose_filter(settings):
    return PoseFilter(settings)


def play(pose_filter, step):
    kind, *values = step
    if kind == "predict":
        pose_filter.predict(values[0], belts_fail=values[1], gyro_fails=values[2])
    elif kind == "gyro":
        pose_filter.update_gyro(values[0], 0, standing=values[1])
    elif kind == "rolled":
        pose_filter.update_rolled(values[0], values[1], 0, learn=True)
    elif kind == "belt yaw":
        pose_filter.update_yaw_rate(*values)
    elif kind == "rebase":
        pose_filter.rebase_rolled()
    elif kind == "doubt":
        pose_filter.doubt_bias()
    else:
        {"stand": pose_filter.stand, "halt": pose_filter.halt, "interrupt": pose_filter.interrupt}[kind](*values)


@settings(max_examples=60)
@given(steps=st.lists(STEPS, max_size=60))
def test_covariance_stays_symmetric_and_positive_definite_for_any_input(robot_settings, steps):
    pose_filter = PoseFilter(robot_settings)
    for step in steps:
        play(pose_filter, step)
        covariance = pose_filter.covariance
        assert np.array_equal(covariance, covariance.T)
        np.linalg.cholesky(covariance)
    pose = pose_filter.odometry(0).pose
    assert -math.pi < pose.yaw_rad <= math.pi
    assert math.isfinite(pose.x_m) and math.isfinite(pose.y_m)


@pytest.fixture(scope="module")
def robot_settings(robot):
    return OdometryFilterSettings.from_robot(robot)


def drive(pose_filter, seconds, speed, rate, **failures):
    rolled = pose_filter.rolled_m
    for index in range(round(seconds / DT)):
        pose_filter.predict(DT, **failures)
        if not failures.get("gyro_fails"):
            pose_filter.update_gyro(rate, 0, standing=False)
        if index % 2 and not failures.get("belts_fail"):
            rolled += 2.0 * DT * speed
            pose_filter.update_rolled(rolled, 0.0, 0, learn=True)


def test_circle_closes(pose_filter):
    drive(pose_filter, 2.0, 0.3, 0.0)
    start = pose_filter.odometry(0).pose
    drive(pose_filter, 10.0, 0.3, 2.0 * math.pi / 10.0)
    pose = pose_filter.odometry(0).pose
    assert math.hypot(pose.x_m - start.x_m, pose.y_m - start.y_m) < 0.005


def test_speed_fades_and_grows_uncertain_without_belts(pose_filter):
    drive(pose_filter, 2.0, 0.3, 0.0)
    before = pose_filter.odometry(0)
    drive(pose_filter, 2.0, 0.3, 0.0, belts_fail=True)
    after = pose_filter.odometry(0)
    assert before.twist.speed_mps == pytest.approx(0.3, abs=0.01)
    assert abs(after.twist.speed_mps) < 0.05
    assert after.twist_covariance[0, 0] > 100.0 * before.twist_covariance[0, 0]
    assert after.pose_covariance[0, 0] > 10.0 * before.pose_covariance[0, 0]


def test_heading_grows_uncertain_without_gyro(pose_filter):
    drive(pose_filter, 2.0, 0.3, 0.4)
    before = pose_filter.odometry(0).pose_covariance[2, 2]
    for _ in range(240):
        pose_filter.predict(DT, gyro_fails=True)
        pose_filter.update_yaw_rate(0.4, 0.08**2)
    assert pose_filter.odometry(0).pose_covariance[2, 2] > 5.0 * before


def test_rest_freezes_the_pose_and_learns_the_bias(pose_filter):
    drive(pose_filter, 2.0, 0.3, 0.2)
    frozen = pose_filter.odometry(0).pose
    for _ in range(240):
        pose_filter.stand(DT)
        pose_filter.update_gyro(0.01, 0, standing=True)
    assert pose_filter.odometry(0).pose == frozen
    assert pose_filter.gyro_bias_radps == pytest.approx(0.01, abs=1e-3)
    assert pose_filter.covariance[BIAS, BIAS] < 1e-6


def test_first_reading_at_rest_does_not_move_the_pose_after_minutes_with_an_unsure_bias(pose_filter):
    drive(pose_filter, 120.0, 0.3, 0.0)
    frozen = pose_filter.odometry(0).pose
    pose_filter.come_to_rest()
    pose_filter.update_gyro(0.01, 0, standing=True)
    assert pose_filter.odometry(0).pose == frozen
    assert pose_filter.gyro_bias_radps > 0.005


def test_interruption_keeps_the_pose_and_the_bias(pose_filter):
    drive(pose_filter, 2.0, 0.3, 0.2)
    before, bias = pose_filter.odometry(0), pose_filter.gyro_bias_radps
    pose_filter.interrupt(1.0)
    after = pose_filter.odometry(0)
    assert after.pose == before.pose and pose_filter.gyro_bias_radps == bias
    assert after.twist.speed_mps == 0.0
    assert np.all(np.diag(after.pose_covariance) > np.diag(before.pose_covariance))


def test_restart_is_sure_of_its_pose(pose_filter):
    drive(pose_filter, 2.0, 0.3, 0.2)
    pose_filter.restart(Pose2(1.0, -2.0, 4.0))
    pose = pose_filter.odometry(0).pose
    assert pose == Pose2(1.0, -2.0, pytest.approx(4.0 - 2.0 * math.pi))
    assert np.all(np.diag(pose_filter.odometry(0).pose_covariance) < 1e-6)
