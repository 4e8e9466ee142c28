"""Extended Kalman filter of pose, speeds and gyro bias."""

import math

import numpy as np
from filterpy.kalman import ExtendedKalmanFilter
from numpy.typing import NDArray

from tracked_localization.adaptive_noise import AdaptiveNoise
from tracked_localization.constant_twist import constant_twist_step
from tracked_localization.innovation import Innovation
from tracked_localization.settings import OdometryFilterSettings
from tracked_types import Odometry, Pose2, Twist2, wrap_angle

Array = NDArray[np.float64]

X, Y, YAW, SPEED, YAW_RATE, BIAS, ROLLED = range(7)
_SIZE = 7
_VARIANCE_FLOOR = 1e-12
_VARIANCE_CEILING = np.array([1e4, 1e4, 1e2, 1.0, 10.0, 1e-2, 1e2])
_START_VARIANCE = 1e-8
_STANDING_VARIANCE = 1e-10
_NOISE_FLOOR = 0.02
_RESTING_TIME_S = 0.5


class PoseFilter:
    """State (x, y, yaw, forward speed, yaw rate, gyro bias, rolled distance) of a slipping tracked robot.

    Both speeds are means over the step that ended last, because that is what the sensors measure: a gyro
    its mean rate over a period, a belt counter the distance. The rolled distance makes the counter a
    direct measurement, so that rounding to ticks stays an error of the distance and does not grow into
    one of the speed. The belts witness forward speed only; their yaw rate is wrong by a fifth on tracks.
    """

    def __init__(self, settings: OdometryFilterSettings) -> None:
        self._settings = settings
        self._ekf = ExtendedKalmanFilter(dim_x=_SIZE, dim_z=1)
        self._ekf.predict_x = self._move
        self._step = constant_twist_step(0.0, 0.0, 0.0, 0.0)
        self._rest_s = 0.0
        acceleration, yaw_acceleration = settings.belt_acceleration_mps2, settings.yaw_acceleration_radps2
        self._speed_noise = _noise(acceleration, settings.tracks_rate_hz)
        self._yaw_rate_noise = _noise(yaw_acceleration, settings.imu_rate_hz)
        self._gyro_variance = max(settings.gyro_noise_radps, 1e-5) ** 2
        # Mean of two counters, each rounded to whole ticks.
        self._rolled_variance = settings.encoder_tick_m**2 / 24.0
        self._gyro_row = _row(YAW_RATE, BIAS)
        self._rolled_row = _row(ROLLED)
        self._rate_row = _row(YAW_RATE)
        self._bias_row = _row(BIAS)
        self.restart(Pose2(0.0, 0.0, 0.0), forget_bias=True)

    @property
    def state(self) -> Array:
        """(7,) the state; a copy."""
        return np.array(self._ekf.x)

    @property
    def covariance(self) -> Array:
        """(7, 7) its covariance; a copy."""
        return np.array(self._ekf.P)

    @property
    def gyro_bias_radps(self) -> float:
        """Estimated bias of the gyro."""
        return float(self._ekf.x[BIAS])

    @property
    def gyro_bias_variance(self) -> float:
        """Variance of that estimate."""
        return float(self._ekf.P[BIAS, BIAS])

    @property
    def rolled_m(self) -> float:
        """Distance that the belts have rolled, as the filter sees it."""
        return float(self._ekf.x[ROLLED])

    def restart(self, pose: Pose2, *, forget_bias: bool = False) -> None:
        """Begin anew at ``pose``, surely known, with unknown speeds."""
        bias, bias_variance = (0.0, self._settings.initial_gyro_bias_deviation_radps**2)
        if not forget_bias:
            bias, bias_variance = self.gyro_bias_radps, self.gyro_bias_variance
        self._ekf.x = np.array([pose.x_m, pose.y_m, wrap_angle(pose.yaw_rad), 0.0, 0.0, bias, 0.0])
        self._ekf.P = np.diag(
            [_START_VARIANCE] * 3 + [*self._unknown_twist_variance(), bias_variance, self._rolled_variance]
        )
        self._speed_noise.restart()
        self._yaw_rate_noise.restart()

    def interrupt(self, gap_s: float) -> None:
        """Go on after ``gap_s`` without any sensor: same pose, less sure of it, unknown speeds."""
        covariance = np.zeros((_SIZE, _SIZE))
        reach = min(gap_s, 10.0) * np.array([self._settings.belt_speed_limit_mps] * 2 + [self._settings.yaw_rate_limit_radps])
        covariance[:3, :3] = self._ekf.P[:3, :3] + np.diag(reach**2)
        covariance[3:, 3:] = np.diag([*self._unknown_twist_variance(), self.gyro_bias_variance, self._rolled_variance])
        self._ekf.x[SPEED] = self._ekf.x[YAW_RATE] = 0.0
        self._ekf.P = covariance
        self._tidy()
        self._speed_noise.restart()
        self._yaw_rate_noise.restart()

    def predict(self, duration_s: float, *, belts_fail: bool = False, gyro_fails: bool = False) -> None:
        """Move on by ``duration_s``, with more noise for the speeds that no sensor watches."""
        settings, state = self._settings, self._ekf.x
        if belts_fail:
            # Nobody knows whether the belts still turn: the best guess fades towards rest.
            self._rest_s = _RESTING_TIME_S
            self._speed_noise.restart()
        else:
            self._rest_s = 0.0
        if gyro_fails:
            self._yaw_rate_noise.restart()
        speed, yaw_rate = float(state[SPEED]), float(state[YAW_RATE])
        covariance = self._ekf.P
        fading = math.exp(-duration_s / self._rest_s) if self._rest_s else 1.0
        covariance[SPEED, :] *= fading
        covariance[:, SPEED] *= fading
        covariance[SPEED, SPEED] += self._speed_noise.intensity * duration_s
        covariance[YAW_RATE, YAW_RATE] += self._yaw_rate_noise.intensity * duration_s
        covariance[BIAS, BIAS] += settings.gyro_bias_walk_radps_sqrt_s**2 * duration_s
        speed *= fading
        state[SPEED] = speed
        step = self._step = constant_twist_step(float(state[YAW]), speed, yaw_rate, duration_s)
        transition = np.eye(_SIZE)
        transition[X, YAW : BIAS] = step.x_per_yaw, step.x_per_speed, step.x_per_rate
        transition[Y, YAW : BIAS] = step.y_per_yaw, step.y_per_speed, step.y_per_rate
        transition[YAW, YAW_RATE] = duration_s
        transition[ROLLED, SPEED] = duration_s
        self._ekf.F = transition
        self._ekf.Q = self._slip_noise(speed, yaw_rate, duration_s, gyro_fails)
        self._ekf.predict()
        self._tidy()

    def stand(self, duration_s: float) -> None:
        """Let ``duration_s`` pass at rest: only the gyro's bias may change."""
        state, covariance = self._ekf.x, self._ekf.P
        state[SPEED] = state[YAW_RATE] = 0.0
        bias_variance = self.gyro_bias_variance + self._settings.gyro_bias_walk_radps_sqrt_s**2 * duration_s
        covariance[3:, :] = 0.0
        covariance[:, 3:] = 0.0
        covariance[SPEED, SPEED] = covariance[YAW_RATE, YAW_RATE] = _STANDING_VARIANCE
        covariance[BIAS, BIAS] = bias_variance
        covariance[ROLLED, ROLLED] = self._rolled_variance
        self._tidy()

    def expect_gyro(self) -> tuple[float, float]:
        """Gyro reading to expect and the variance of the difference (rad/s, (rad/s)^2)."""
        state, covariance = self._ekf.x, self._ekf.P
        variance = covariance[YAW_RATE, YAW_RATE] + 2.0 * covariance[YAW_RATE, BIAS] + covariance[BIAS, BIAS]
        return float(state[YAW_RATE] + state[BIAS]), float(variance) + self._gyro_variance

    def update_gyro(self, rate_radps: float, stamp_ns: int, duration_s: float, *, standing: bool) -> Innovation:
        """Fuse a gyro reading; at rest it is a reading of the bias."""
        expected, variance = self.expect_gyro()
        innovation = rate_radps - expected
        row = self._bias_row if standing else self._gyro_row
        self._correct(rate_radps, row, self._gyro_variance)
        if not standing and duration_s > 0.0:
            self._yaw_rate_noise.observe(innovation * innovation, variance, duration_s)
        return Innovation(stamp_ns, "imu", innovation, variance)

    def update_rolled(self, rolled_m: float, added_variance: float, stamp_ns: int, duration_s: float) -> Innovation:
        """Fuse the distance rolled by the belts; ``added_variance`` (m^2) comes on top of the rounding."""
        noise = self._rolled_variance + added_variance
        variance = float(self._ekf.P[ROLLED, ROLLED]) + noise
        innovation = rolled_m - self.rolled_m
        self._correct(rolled_m, self._rolled_row, noise)
        # A random walk of the speed over two equal halves of a period reaches the distance like this.
        if duration_s > 0.0:
            self._speed_noise.observe(innovation * innovation, variance, 0.625 * duration_s**3)
        return Innovation(stamp_ns, "tracks", innovation, variance)

    def update_yaw_rate(self, rate_radps: float, variance: float) -> None:
        """Fuse a yaw rate from another witness than the gyro."""
        self._correct(rate_radps, self._rate_row, variance)

    def rebase_rolled(self) -> None:
        """Forget how the rolled distance came about: the counter starts anew from here."""
        covariance = self._ekf.P
        covariance[ROLLED, :] = 0.0
        covariance[:, ROLLED] = 0.0
        covariance[ROLLED, ROLLED] = self._rolled_variance

    def doubt_bias(self) -> None:
        """Learn the gyro's bias anew: it has changed."""
        covariance = self._ekf.P
        covariance[BIAS, :] = 0.0
        covariance[:, BIAS] = 0.0
        covariance[BIAS, BIAS] = self._settings.gyro_bias_limit_radps**2

    def odometry(self, stamp_ns: int) -> Odometry:
        """The state as odometry."""
        state, covariance = self._ekf.x, self._ekf.P
        return Odometry(
            stamp_ns=stamp_ns,
            frame_id=self._settings.odom_frame,
            child_frame_id=self._settings.base_frame,
            pose=Pose2(float(state[X]), float(state[Y]), float(state[YAW])),
            twist=Twist2(float(state[SPEED]), float(state[YAW_RATE])),
            pose_covariance=covariance[:3, :3].copy(),
            twist_covariance=covariance[3:5, 3:5].copy(),
        )

    def _move(self, _input: object = 0) -> None:
        state, step = self._ekf.x, self._step
        state[X] += step.x_m
        state[Y] += step.y_m
        state[YAW] = wrap_angle(float(state[YAW]) + step.yaw_rad)
        state[ROLLED] += float(state[SPEED]) * float(self._ekf.F[ROLLED, SPEED])

    def _slip_noise(self, speed: float, yaw_rate: float, duration_s: float, gyro_fails: bool) -> Array:
        settings = self._settings
        # Slip is alike for a while; white noise of the same long-run growth has 2 x time x variance.
        spread = 2.0 * settings.slip_correlation_s * duration_s
        along = (settings.longitudinal_slip * speed) ** 2 * spread
        across = (settings.lateral_slip_m * yaw_rate) ** 2 * spread
        turning = (settings.belt_yaw_ratio_deviation * yaw_rate) ** 2 * spread if gyro_fails else 0.0
        heading = float(self._ekf.x[YAW])
        cosine, sine = math.cos(heading), math.sin(heading)
        noise = np.zeros((_SIZE, _SIZE))
        noise[X, X] = along * cosine * cosine + across * sine * sine
        noise[Y, Y] = along * sine * sine + across * cosine * cosine
        noise[X, Y] = noise[Y, X] = (along - across) * sine * cosine
        noise[YAW, YAW] = turning
        return noise

    def _unknown_twist_variance(self) -> tuple[float, float]:
        settings = self._settings
        return (0.3 * settings.belt_speed_limit_mps) ** 2, (0.3 * settings.yaw_rate_limit_radps) ** 2

    def _correct(self, value: float, row: Array, variance: float) -> None:
        self._ekf.update(
            np.array([value]), lambda _state: row, lambda state: row @ state, R=np.array([[variance]])
        )
        self._ekf.x[YAW] = wrap_angle(float(self._ekf.x[YAW]))
        self._tidy()

    def _tidy(self) -> None:
        """Keep the covariance symmetric, positive definite and bounded, whatever was fused."""
        covariance = self._ekf.P
        covariance += covariance.T
        covariance *= 0.5
        diagonal = covariance.diagonal()
        if (diagonal > _VARIANCE_CEILING).any():
            # Scaling rows and columns alike keeps a matrix positive definite; clipping the diagonal does not.
            scale = np.sqrt(np.minimum(1.0, _VARIANCE_CEILING / diagonal))
            covariance *= scale[:, None] * scale
        covariance.flat[:: _SIZE + 1] += _VARIANCE_FLOOR


def _row(*ones: int) -> Array:
    row = np.zeros((1, _SIZE))
    row[0, list(ones)] = 1.0
    return row


def _noise(acceleration: float, rate_hz: int) -> AdaptiveNoise:
    """Noise whose ceiling lets a speed change by ``acceleration`` between two samples."""
    ceiling = acceleration**2 / rate_hz
    return AdaptiveNoise(floor=_NOISE_FLOOR**2 * ceiling, ceiling=ceiling, memory=12.0)
