"""Fusion of samples that come in the order of their stamps."""

from collections import deque
from dataclasses import dataclass, field, replace
from typing import cast

from tracked_localization.belt_pair import BeltMotion, BeltPair
from tracked_localization.gyro_gate import GyroGate
from tracked_localization.gyro_record import GyroRecord
from tracked_localization.health import IMU, BlameList, Fault
from tracked_localization.innovation import Innovation
from tracked_localization.pose_filter import PoseFilter
from tracked_localization.pose_fusion import PoseFusion
from tracked_localization.settings import OdometryFilterSettings
from tracked_localization.slip import SlipEstimator, slip_at, unknown_slip
from tracked_localization.standstill import Standstill
from tracked_types import ImuSample, Odometry, Pose2, PoseSample, Slip, TrackSample, seconds_between

_SURE_REST_S = 0.1


@dataclass(slots=True)
class _Inputs:
    """What was heard since the time line began.

    The stamps are those of the first sample, of the last credible gyro reading, of the last tracks sample and
    of the last credible travel. rolled_m adds up the travel; belt_rate is the belts' yaw rate with its stamp.
    """

    start_ns: int | None = None
    gyro_ns: int | None = None
    tracks_ns: int | None = None
    rolled_ns: int | None = None
    rolled_m: float = 0.0
    belt_rate: tuple[int, float] | None = None
    slip: Slip = field(default_factory=lambda: unknown_slip(0))
    bias_hopeless: bool = False


class SensorFusion:
    """Judges samples, keeps `PoseFilter` and slip up to date, and tells ``blames`` who misbehaved.

    A sensor fails when it has said nothing credible for the time of silence. The yaw rate then comes from
    the belts, corrected by their usual loss and much less certain; without the belts the speed fades.
    """

    def __init__(self, settings: OdometryFilterSettings, blames: BlameList) -> None:
        self._settings = settings
        self._blames = blames
        self._filter = PoseFilter(settings)
        self._poses = PoseFusion(settings, self._filter, blames)
        self._gyro = GyroGate(settings)
        self._belts = BeltPair(settings)
        self._gyro_record = GyroRecord()
        self._standstill = Standstill(settings)
        self._slip_estimator = SlipEstimator(settings.slip)
        self.innovations: deque[Innovation] = deque(maxlen=64)
        self.time_ns: int | None = None
        """Stamp of the state; None before the first sample."""
        self._inputs = _Inputs()
        self._at_rest: deque[tuple[float, int]] = deque()
        self._rested = False
        self._rest_samples = round(_SURE_REST_S * settings.imu_rate_hz)

    @property
    def standing(self) -> bool:
        """Whether the robot is at rest."""
        return self._standstill.standing

    @property
    def gyro_bias_radps(self) -> float:
        """Estimated bias of the gyro about the vertical."""
        return self._filter.gyro_bias_radps

    @property
    def imu_fails(self) -> bool:
        """Whether the IMU has said nothing credible lately."""
        return self._unheard(self._inputs.gyro_ns)

    @property
    def tracks_fail(self) -> bool:
        """Whether neither belt has said anything credible lately."""
        return self._unheard(self._inputs.rolled_ns)

    def odometry(self, stamp_ns: int) -> Odometry:
        """The present state, stamped."""
        return self._filter.odometry(stamp_ns)

    def slip(self, instant_ns: int) -> Slip:
        """Slip over the last belt period, stamped, unknown if that is long ago; with the slide in any case."""
        slip = slip_at(self._inputs.slip, instant_ns, self._settings.silence_s)
        return replace(slip, slide_s=self._filter.slide_s)

    def restart(self, pose: Pose2) -> None:
        """Put the robot at ``pose``, surely known."""
        self._filter.restart(pose)
        self._poses.restart()
        self._inputs.rolled_m = self._filter.rolled_m

    def interrupt(self, start_ns: int, gap_s: float) -> None:
        """Go on at ``start_ns`` after a time without sensors: same pose, speeds unknown, inputs forgotten."""
        self._filter.interrupt(gap_s)
        self._gyro.restart()
        self._belts.restart()
        self._gyro_record.clear()
        self._standstill.restart()
        self._at_rest.clear()
        self.time_ns = start_ns
        self._inputs = _Inputs(start_ns=start_ns, rolled_m=self._filter.rolled_m)
        self._poses.restart()

    def expect_poses(self) -> None:
        """Be ready for measured poses of the time from now on."""
        self._filter.expect_poses()

    def fuse_pose(self, sample: PoseSample, now_ns: int | None) -> None:
        """Take in a pose of the past, or of a moment that is still to come; ``now_ns``: newest stamp of any sensor."""
        self._poses.add(sample, now_ns)

    def remember(self, stamp_ns: int) -> None:
        """All that is to come up to ``stamp_ns`` has come: poses of it may be fused from now on."""
        self._filter.remember(stamp_ns)
        self._poses.catch_up()

    def advance(self, stamp_ns: int) -> None:
        """Predict to ``stamp_ns``; with nobody to ask, the pose stays where it is."""
        if self.time_ns is None:
            self.time_ns = self._inputs.start_ns = stamp_ns
        duration = seconds_between(stamp_ns, self.time_ns)
        if duration <= 0.0:
            return
        self.time_ns = stamp_ns
        imu_fails, tracks_fail = self.imu_fails, self.tracks_fail
        if self.standing:
            self._filter.stand(duration)
        elif imu_fails and tracks_fail:
            self._filter.halt(duration)
        else:
            self._filter.predict(duration, belts_fail=tracks_fail, gyro_fails=imu_fails)

    def fuse_imu(self, sample: ImuSample) -> None:
        """Take in the mean yaw rate of the period that ends with the sample."""
        stamp_ns = sample.stamp_ns
        expected, variance = self._filter.expect_gyro()
        reading = self._gyro.update(sample, expected, variance, self._belt_yaw_rate(stamp_ns))
        if reading.fault is not None:
            self._blames.blame(IMU, reading.fault, stamp_ns)
        self._gyro_record.add(stamp_ns, reading.rate_radps)
        moved = not self.standing
        self._standstill.add_gyro(
            stamp_ns, reading.rate_radps, self._filter.gyro_bias_radps, self._filter.gyro_bias_variance
        )
        if self.standing and moved:
            self._filter.come_to_rest()
        self._check_bias(stamp_ns)
        if reading.rate_radps is None:
            return
        self._inputs.gyro_ns = stamp_ns
        if not self.standing:
            if self._rested:
                self._filter.leave_rest()
            self._rested = False
            self._at_rest.clear()
            self.innovations.append(self._filter.update_gyro(reading.rate_radps, stamp_ns, standing=False))
            return
        self._rested = True
        if not self._inputs.bias_hopeless:
            self._learn_bias(reading.rate_radps, stamp_ns)

    def _learn_bias(self, rate_radps: float, stamp_ns: int) -> None:
        """A reading at rest shows the bias, once it is sure that it was one: the body moves before a belt counts."""
        self._at_rest.append((rate_radps, stamp_ns))
        if len(self._at_rest) > self._rest_samples:
            rate, at_ns = self._at_rest.popleft()
            self.innovations.append(self._filter.update_gyro(rate, at_ns, standing=True))

    def fuse_tracks(self, sample: TrackSample) -> None:
        """Take in the travel of both belts since the last sample."""
        stamp_ns = sample.stamp_ns
        last_ns, self._inputs.tracks_ns = self._inputs.tracks_ns, stamp_ns
        turning = self._gyro_record.mean(last_ns, stamp_ns) if last_ns is not None else None
        yaw_rate = turning[0] - self._filter.gyro_bias_radps if turning is not None else None
        motion = self._belts.update(sample, yaw_rate)
        for sensor, fault in motion.faults:
            self._blames.blame(sensor, fault, stamp_ns)
        self._standstill.add_belts(motion)
        self._inputs.slip = unknown_slip(stamp_ns)
        if last_ns is None:
            return
        self._roll(motion)
        if motion.left_m is None or motion.right_m is None:
            return
        belt_rate = motion.turn_rad(self._settings.gauge_m) / motion.duration_s
        self._inputs.belt_rate = (stamp_ns, belt_rate)
        if turning is not None and yaw_rate is not None:
            variance = self._settings.gyro_noise_radps**2 / turning[1] + self._filter.gyro_bias_variance
            left, right = motion.left_m / motion.duration_s, motion.right_m / motion.duration_s
            self._inputs.slip = self._slip_estimator.update(
                stamp_ns, left, right, yaw_rate, variance, motion.duration_s
            )
            self._inputs.slip = self._as_poses_show(self._inputs.slip, 0.5 * (left + right))
        elif self.imu_fails and not self.standing:
            self._filter.update_yaw_rate(*self._yaw_rate_of_belts(belt_rate))

    def _as_poses_show(self, slip: Slip, belt_speed_mps: float) -> Slip:
        """Where measured poses show what the ground takes of the speed, that replaces the assumption (5.2.8)."""
        share = self._filter.lost_share
        if share is None or not slip.known:
            return slip
        speed, variance = -share[0] * belt_speed_mps, share[1] * belt_speed_mps**2
        turn = (slip.yaw_rate_radps, slip.yaw_rate_variance)
        return Slip(slip.stamp_ns, speed, turn[0], variance, turn[1], known=True, speed_measured=True)

    def _check_bias(self, stamp_ns: int) -> None:
        """At rest the gyro shows its bias; a bias that is not the one known is a fault of the gyro."""
        rate = self._standstill.new_bias_radps
        if rate is None:
            return
        self._blames.blame(IMU, Fault.BIASED, stamp_ns)
        self._inputs.bias_hopeless = abs(rate) > self._settings.gyro_bias_limit_radps
        self._filter.doubt_bias()

    def _roll(self, motion: BeltMotion) -> None:
        """Fuse the forward travel, from both belts or, with the yaw rate's help, from one."""
        travel = self._forward(motion)
        if travel is None:
            self._filter.rebase_rolled()
            self._inputs.rolled_m = self._filter.rolled_m
            return
        self._inputs.rolled_ns = motion.stamp_ns
        self._inputs.rolled_m += travel[0]
        if self.standing:
            self._inputs.rolled_m = self._filter.rolled_m
            return
        # Rounding to ticks is noise only while ticks go by; a counter at rest says nothing about the noise.
        going = max(abs(travel[0]), abs(self._filter.speed_mps) * motion.duration_s) >= self._settings.encoder_tick_m
        innovation = self._filter.update_rolled(self._inputs.rolled_m, travel[1], motion.stamp_ns, learn=going)
        if going:
            self.innovations.append(innovation)

    def _forward(self, motion: BeltMotion) -> tuple[float, float] | None:
        """Forward travel (m) and the variance that it has beyond rounding (m^2)."""
        if motion.left_m is not None and motion.right_m is not None:
            return 0.5 * (motion.left_m + motion.right_m), 0.0
        if motion.left_m is None and motion.right_m is None:
            return None
        settings = self._settings
        turn = self._filter.yaw_rate_radps * motion.duration_s / settings.belt_yaw_ratio
        half = 0.5 * settings.gauge_m * turn
        deviation = half * settings.belt_yaw_ratio_deviation / settings.belt_yaw_ratio + settings.encoder_tick_m
        if motion.left_m is not None:
            return motion.left_m + half, deviation**2
        return cast(float, motion.right_m) - half, deviation**2

    def _yaw_rate_of_belts(self, belt_rate: float) -> tuple[float, float]:
        """The body's yaw rate as far as the belts tell it, and its variance."""
        settings = self._settings
        rounding = settings.encoder_tick_m * settings.tracks_rate_hz / settings.gauge_m
        deviation = settings.belt_yaw_ratio_deviation * abs(belt_rate) + rounding
        return settings.belt_yaw_ratio * belt_rate, deviation**2

    def _belt_yaw_rate(self, now_ns: int) -> float | None:
        if (
            self._inputs.belt_rate is None
            or seconds_between(now_ns, self._inputs.belt_rate[0]) > self._settings.silence_s
        ):
            return None
        return self._inputs.belt_rate[1]

    def _unheard(self, credible_ns: int | None) -> bool:
        since_ns = self._inputs.start_ns if credible_ns is None else credible_ns
        if self.time_ns is None or since_ns is None:
            return False
        return seconds_between(self.time_ns, since_ns) > self._settings.silence_s
