"""What a step does to the filter's state, and what happens during it unseen."""

import math

import numpy as np

from tracked_localization.constant_twist import TwistStep
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
)

_ACCELERATION_MEMORY_S = 0.2
_IDENTITY = np.eye(SIZE)


def transition(
    step: TwistStep, duration_s: float, fading: float, belt_speed_mps: float, lost_share: float, *, learning: bool
) -> Array:
    """Jacobian (11, 11) of a step: accelerations move the speeds, then the new speeds move the pose.

    ``fading``: share of the forward speed that is left after the step; ``lost_share`` of the new belt speed the ground
    does not give back, so that the pose moves by the rest. ``learning``: whether anybody learns that share, and the
    slide; unknowns that nobody learns stay out of the game.
    """
    jacobian = _IDENTITY.copy()
    jacobian[X, YAW] = step.x_per_yaw
    jacobian[Y, YAW] = step.y_per_yaw
    kept_share = 1.0 - lost_share
    if learning:
        jacobian[X, SHARE] = -belt_speed_mps * step.x_per_speed
        jacobian[Y, SHARE] = -belt_speed_mps * step.y_per_speed
        jacobian[X, SLIDE] = step.x_per_slide
        jacobian[Y, SLIDE] = step.y_per_slide
    moved_by_speed = ((X, kept_share * step.x_per_speed), (Y, kept_share * step.y_per_speed), (ROLLED, duration_s))
    moved_by_rate = ((X, step.x_per_rate), (Y, step.y_per_rate), (YAW, duration_s))
    speeds = (
        (SPEED, ACCELERATION, fading, moved_by_speed),
        (YAW_RATE, YAW_ACCELERATION, 1.0, moved_by_rate),
    )
    memory = math.exp(-duration_s / _ACCELERATION_MEMORY_S)
    for speed, acceleration, kept, moved in speeds:
        jacobian[speed, speed] = kept
        jacobian[speed, acceleration] = duration_s
        jacobian[acceleration, acceleration] = memory
        for component, per_speed in moved:
            jacobian[component, speed] = per_speed * kept
            jacobian[component, acceleration] = per_speed * duration_s
    return jacobian


def unseen_motion(
    settings: OdometryFilterSettings,
    heading_rad: float,
    speed_mps: float,
    yaw_rate_radps: float,
    duration_s: float,
    *,
    gyro_fails: bool,
    learning: bool = False,
) -> Array:
    """Covariance (11, 11) of what no sensor sees during a step: slip along and across, and the bias's walk.

    Without a gyro the yaw rate comes from the belts, and its error lasts as slip does.
    ``learning``: whether measured poses show the slide, so that less of the slip across is unseen.
    """
    # Slip is alike for a while; white noise of the same long-run growth has 2 x time x variance.
    spread = 2.0 * settings.slip_correlation_s * duration_s
    along = (settings.longitudinal_slip * speed_mps) ** 2 * spread
    lateral_slip_m = settings.lateral_slip_beside_slide_m if learning else settings.lateral_slip_m
    across = (lateral_slip_m * yaw_rate_radps) ** 2 * spread
    cosine, sine = math.cos(heading_rad), math.sin(heading_rad)
    noise = np.zeros((SIZE, SIZE))
    noise[X, X] = along * cosine * cosine + across * sine * sine
    noise[Y, Y] = along * sine * sine + across * cosine * cosine
    noise[X, Y] = noise[Y, X] = (along - across) * sine * cosine
    if gyro_fails:
        noise[YAW, YAW] = (settings.belt_yaw_ratio_deviation * yaw_rate_radps) ** 2 * spread
    noise[BIAS, BIAS] = settings.gyro_bias_walk_radps_sqrt_s**2 * duration_s
    return noise
