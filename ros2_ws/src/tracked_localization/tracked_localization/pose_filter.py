"""Extended Kalman filter of pose, speeds and gyro bias."""

import math

import numpy as np

from tracked_localization.adaptive_noise import AdaptiveNoise
from tracked_localization.constant_twist import constant_twist_step
from tracked_localization.initial_state import initial_state
from tracked_localization.innovation import Innovation
from tracked_localization.pose_memory import PoseMemory, Snapshot
from tracked_localization.process_model import transition, unseen_motion
from tracked_localization.readout import odometry_of
from tracked_localization.scalar_filter import ScalarFilter
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
    forget,
    keep_positive_definite,
    lift,
    row,
)
from tracked_types import Odometry, Pose2, to_nanoseconds, wrap_angle

_START_VARIANCE = 1e-8
_STANDING_VARIANCE = 1e-10
_FADING_S = 0.5
_UNSEEN_START_S = 0.05
_GYRO_ROW = row(YAW_RATE, BIAS)
_BIAS_ROW = row(BIAS)
_RATE_ROW = row(YAW_RATE)
_ROLLED_ROW = row(ROLLED)


class PoseFilter:
    """Where a slipping tracked robot is, from the distance its belts roll and the rate its gyro shows.

    State: x, y, yaw, forward speed, yaw rate, gyro bias, rolled distance, both accelerations, which fade within
    moments, and two properties of the ground that only measured poses show: the share of the belts' speed that it
    takes, and the slide. Both speeds are means over the step that ended last, because that is what the sensors
    measure: a gyro its mean rate over a period, a belt counter the distance. The rolled distance makes the counter
    a direct measurement, so that rounding to ticks stays an error of the distance and does not grow into one of the
    speed. The belts witness forward speed only: their yaw rate is wrong by a fifth on tracks.
    """

    def __init__(self, settings: OdometryFilterSettings) -> None:
        self._settings = settings
        self._ekf = ScalarFilter(SIZE)
        self._ekf.predict_x = self._move
        self._step = constant_twist_step(0.0, 0.0, 0.0, 0.0)
        self._rolled_step_m = 0.0
        self.memory = PoseMemory(to_nanoseconds(settings.pose_patience_s))
        belts, body = settings.belt_acceleration_mps2, settings.body_yaw_acceleration_radps2
        # Per second: the ceiling lets an acceleration build up within a sample, the floor over minutes.
        self._speed_noise = AdaptiveNoise(1e-5 * belts**2, 1e3 * belts**2, rate=0.15)
        self._yaw_noise = AdaptiveNoise(1e-5 * body**2, 1e3 * body**2, rate=0.15)
        self._gyro_variance = max(settings.gyro_noise_radps, 1e-5) ** 2
        self._rolled_variance = settings.rolled_variance_m2
        self._ekf.x = np.zeros(SIZE)
        self._ekf.P = np.eye(SIZE)
        self._ekf.P[BIAS, BIAS] = settings.initial_gyro_bias_deviation_radps**2
        self.restart(Pose2(0.0, 0.0, 0.0))

    @property
    def covariance(self) -> Array:
        """Covariance (11, 11) of the state; a copy."""
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

    @property
    def speed_mps(self) -> float:
        """Estimated forward speed."""
        return float(self._ekf.x[SPEED])

    @property
    def yaw_rate_radps(self) -> float:
        """Estimated yaw rate of the body."""
        return float(self._ekf.x[YAW_RATE])

    @property
    def lost_share(self) -> tuple[float, float] | None:
        """Share of the belts' speed that the ground takes, and its variance; None while no pose shows it."""
        if not self.memory.active:
            return None
        return float(self._ekf.x[SHARE]), float(self._ekf.P[SHARE, SHARE])

    @property
    def slide_s(self) -> float:
        """Angle by which the robot moves outwards off its heading, per yaw rate."""
        return float(self._ekf.x[SLIDE])

    def restart(self, pose: Pose2) -> None:
        """Begin anew at ``pose``, surely known, with unknown speeds; the gyro's bias is kept."""
        self._begin(pose, np.diag([_START_VARIANCE] * 3))

    def interrupt(self, gap_s: float) -> None:
        """Go on after ``gap_s`` without any sensor: same pose, less sure of it, unknown speeds."""
        settings = self._settings
        fastest = np.array([settings.belt_speed_limit_mps] * 2 + [settings.yaw_rate_limit_radps])
        spread = np.diag((min(gap_s, 10.0) * fastest) ** 2)
        self._begin(self.odometry(0).pose, self._ekf.P[:3, :3] + spread)

    def predict(self, duration_s: float, *, belts_fail: bool = False, gyro_fails: bool = False) -> None:
        """Move on by ``duration_s``, with all the noise a manoeuvre can cause where no sensor watches."""
        settings, state, covariance = self._settings, self._ekf.x, self._ekf.P
        heading, fading = float(state[YAW]), 1.0
        if belts_fail:
            # Nobody knows whether the belts still turn: the best guess fades towards rest.
            fading = math.exp(-duration_s / _FADING_S)
            self._speed_noise.expect_anything()
        if gyro_fails:
            self._yaw_noise.expect_anything()
        covariance[ACCELERATION, ACCELERATION] += self._speed_noise.intensity * duration_s
        covariance[YAW_ACCELERATION, YAW_ACCELERATION] += self._yaw_noise.intensity * duration_s
        speed = fading * float(state[SPEED]) + duration_s * float(state[ACCELERATION])
        rate = float(state[YAW_RATE]) + duration_s * float(state[YAW_ACCELERATION])
        state[SPEED], state[YAW_RATE] = speed, rate
        lost = float(state[SHARE])
        self._step = constant_twist_step(heading, (1.0 - lost) * speed, rate, duration_s, float(state[SLIDE]))
        self._rolled_step_m = duration_s * speed
        learning = self.memory.active
        self._ekf.F = transition(self._step, duration_s, fading, speed, lost, learning=learning)
        self._ekf.Q = unseen_motion(
            settings, heading, speed, rate, duration_s, gyro_fails=gyro_fails, learning=learning
        )
        if learning:
            self._ekf.Q[SHARE, SHARE] = settings.slip_share_walk_sqrt_s**2 * duration_s
            self._ekf.Q[SLIDE, SLIDE] = settings.slide_walk_sqrt_s**2 * duration_s
        self._ekf.predict()
        self.memory.carry(self._ekf.F)
        bound(self._ekf.P)
        keep_positive_definite(self._ekf.P)

    def come_to_rest(self) -> None:
        """The pose is frozen from now on, although the body may still sway on its belts.

        What rest tells of the gyro's bias must not move it either: after minutes with an unsure bias, the noise of the
        first reading at rest would.
        """
        self._ekf.P[YAW, YAW] += self._settings.settling_yaw_rad**2
        forget(self._ekf.P, BIAS, self.gyro_bias_variance)
        self.memory.drop(BIAS)

    def leave_rest(self) -> None:
        """The body has begun to turn unseen: what the gyro then shows at once is motion, and no change of its bias."""
        turning = self._settings.body_yaw_acceleration_radps2 * _UNSEEN_START_S
        self._ekf.P[YAW_RATE, YAW_RATE] += turning**2

    def stand(self, duration_s: float) -> None:
        """Let ``duration_s`` pass at rest: only the gyro's bias may change."""
        state, covariance = self._ekf.x, self._ekf.P
        walked = self.gyro_bias_variance + self._settings.gyro_bias_walk_radps_sqrt_s**2 * duration_s
        for component in (SPEED, YAW_RATE, ACCELERATION, YAW_ACCELERATION):
            state[component] = 0.0
            forget(covariance, component, _STANDING_VARIANCE)
        forget(covariance, BIAS, walked)
        forget(covariance, ROLLED, self._rolled_variance)
        keep_positive_definite(covariance)
        self.memory.drop(SPEED, YAW_RATE, BIAS, ROLLED, ACCELERATION, YAW_ACCELERATION)

    def halt(self, duration_s: float) -> None:
        """Let ``duration_s`` pass with nobody to ask: the pose stays, and grows less certain."""
        settings, covariance = self._settings, self._ekf.P
        self.stand(duration_s)
        covariance[X, X] += (settings.belt_speed_limit_mps**2) * duration_s
        covariance[Y, Y] += (settings.belt_speed_limit_mps**2) * duration_s
        covariance[YAW, YAW] += (settings.yaw_rate_limit_radps**2) * duration_s
        bound(covariance)

    def expect_gyro(self) -> tuple[float, float]:
        """Gyro reading to expect and the variance of the difference (rad/s, (rad/s)^2)."""
        state, covariance = self._ekf.x, self._ekf.P
        variance = covariance[YAW_RATE, YAW_RATE] + 2.0 * covariance[YAW_RATE, BIAS] + covariance[BIAS, BIAS]
        return float(state[YAW_RATE] + state[BIAS]), float(variance) + self._gyro_variance

    def update_gyro(self, rate_radps: float, stamp_ns: int, *, standing: bool) -> Innovation:
        """Fuse a gyro reading; at rest it is a reading of the bias."""
        expected, variance = self.expect_gyro()
        innovation = Innovation(stamp_ns, "imu", rate_radps - expected, variance, at_rest=standing)
        self._correct(rate_radps, _BIAS_ROW if standing else _GYRO_ROW, self._gyro_variance)
        if not standing:
            self._yaw_noise.observe(innovation.normalised_square)
        return innovation

    def update_rolled(self, rolled_m: float, added_variance: float, stamp_ns: int, *, learn: bool) -> Innovation:
        """Fuse the distance rolled by the belts; ``added_variance`` (m^2) comes on top of the rounding.

        ``learn``: whether the innovation says how lively the motion is.
        """
        noise = self._rolled_variance + added_variance
        innovation = Innovation(
            stamp_ns, "tracks", rolled_m - self.rolled_m, float(self._ekf.P[ROLLED, ROLLED]) + noise
        )
        self._correct(rolled_m, _ROLLED_ROW, noise)
        if learn:
            self._speed_noise.observe(innovation.normalised_square)
        return innovation

    def update_yaw_rate(self, rate_radps: float, variance: float) -> None:
        """Fuse a yaw rate from another witness than the gyro."""
        self._correct(rate_radps, _RATE_ROW, variance)

    def rebase_rolled(self) -> None:
        """The counter starts anew from the distance the filter believes in."""
        forget(self._ekf.P, ROLLED, self._rolled_variance)
        self.memory.drop(ROLLED)

    def doubt_bias(self) -> None:
        """Learn the gyro's bias anew: it has changed."""
        forget(self._ekf.P, BIAS, self._settings.gyro_bias_limit_radps**2)
        self.memory.drop(BIAS)

    def expect_poses(self) -> None:
        """Poses will show how much of the belts' speed the ground gives back, and the slide: learn both from now on."""
        if not self.memory.active:
            self.memory.begin()
            self._ekf.P[SHARE, SHARE] = self._settings.longitudinal_slip**2
            self._ekf.P[SLIDE, SLIDE] = self._settings.slide_deviation_s**2

    def remember(self, stamp_ns: int) -> None:
        """Keep the present state for measurements of it that are still to come."""
        self.memory.mark(stamp_ns, self._ekf.x, self._ekf.P)

    def correct_past(self, snapshot: Snapshot, innovation: Array, variance: Array) -> None:
        """Correct a state of the past by an ``innovation`` (3,) of its pose with this variance, and the present."""
        self.memory.apply(snapshot, innovation, variance, self._ekf.x, self._ekf.P)
        keep_positive_definite(self._ekf.P)

    def move(self, shift: Pose2, pose_covariance: Array) -> None:
        """Put the robot elsewhere as a whole, by the rigid motion ``shift`` of the frame; its motion goes on."""
        pose = shift.compose(self.odometry(0).pose)
        self._ekf.x[[X, Y, YAW]] = pose.x_m, pose.y_m, pose.yaw_rad
        for component in (X, Y, YAW):
            forget(self._ekf.P, component, 1.0)
        self._ekf.P[:3, :3] = pose_covariance
        keep_positive_definite(self._ekf.P)
        self.memory.clear()

    def odometry(self, stamp_ns: int) -> Odometry:
        """The state as odometry."""
        return odometry_of(self._ekf.x, self._ekf.P, self._settings, stamp_ns, share_is_learnt=self.memory.active)

    def _begin(self, pose: Pose2, pose_covariance: Array) -> None:
        bias = self.gyro_bias_radps, self.gyro_bias_variance
        self._ekf.x, self._ekf.P = initial_state(
            self._settings, pose, pose_covariance, bias, share_is_learnt=self.memory.active
        )
        self.memory.clear()
        self._speed_noise.restart()
        self._yaw_noise.restart()

    def _move(self, _input: object = 0) -> None:
        """State part of filterpy's prediction; the speeds have been moved on before."""
        state, step = self._ekf.x, self._step
        state[X] += step.x_m
        state[Y] += step.y_m
        state[YAW] = wrap_angle(float(state[YAW]) + step.yaw_rad)
        state[ROLLED] += self._rolled_step_m
        memory = float(self._ekf.F[ACCELERATION, ACCELERATION])
        state[ACCELERATION] *= memory
        state[YAW_ACCELERATION] *= memory

    def _correct(self, value: float, selection: Array, variance: float) -> None:
        self._ekf.update_scalar(value, selection, variance)
        self._ekf.x[YAW] = wrap_angle(float(self._ekf.x[YAW]))
        lift(self._ekf.P)
        self.memory.correct(self._ekf.K, selection)
