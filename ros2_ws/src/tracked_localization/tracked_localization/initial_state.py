"""State of the odometry filter before any sensor has spoken."""

import numpy as np

from tracked_localization.settings import OdometryFilterSettings
from tracked_localization.state import (
    ACCELERATION,
    BIAS,
    ROLLED,
    SHARE,
    SIZE,
    SLIDE,
    SPEED,
    YAW,
    YAW_ACCELERATION,
    YAW_RATE,
    Array,
    X,
    Y,
    bound,
    keep_positive_definite,
)
from tracked_types import Pose2, wrap_angle


def initial_state(
    settings: OdometryFilterSettings,
    pose: Pose2,
    pose_covariance: Array,
    bias: tuple[float, float],
    *,
    share_is_learnt: bool,
) -> tuple[Array, Array]:
    """State (11,) and covariance (11, 11) at ``pose`` with unknown speeds; ``bias``: the gyro's, and its variance."""
    state, covariance = np.zeros(SIZE), np.zeros((SIZE, SIZE))
    state[[X, Y, YAW, BIAS]] = pose.x_m, pose.y_m, wrap_angle(pose.yaw_rad), bias[0]
    state[SLIDE] = settings.slide_s
    covariance[:3, :3] = pose_covariance
    for component, deviation in (
        (SPEED, 0.3 * settings.belt_speed_limit_mps),
        (YAW_RATE, 0.3 * settings.yaw_rate_limit_radps),
        (ACCELERATION, 0.3 * settings.belt_acceleration_mps2),
        (YAW_ACCELERATION, 0.3 * settings.body_yaw_acceleration_radps2),
        (SHARE, settings.longitudinal_slip if share_is_learnt else 0.0),
        (SLIDE, settings.slide_deviation_s if share_is_learnt else 0.0),
    ):
        covariance[component, component] = deviation**2
    covariance[BIAS, BIAS] = bias[1]
    covariance[ROLLED, ROLLED] = settings.rolled_variance_m2
    bound(covariance)
    keep_positive_definite(covariance)
    return state, covariance
