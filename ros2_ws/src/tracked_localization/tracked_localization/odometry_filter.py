"""Odometry of a slipping tracked robot from belt counters and a gyro."""

from collections import deque
from collections.abc import Iterator
from typing import cast

from tracked_localization.belt_pair import BeltMotion, BeltPair
from tracked_localization.estimate import Estimate
from tracked_localization.gyro_gate import GyroGate
from tracked_localization.gyro_record import GyroRecord
from tracked_localization.health import IMU, TRACKS, BlameList, Culprit, Fault, Health
from tracked_localization.innovation import Innovation
from tracked_localization.pose_filter import PoseFilter
from tracked_localization.sample_buffer import Arrival, Ready, SampleBuffer
from tracked_localization.settings import OdometryFilterSettings
from tracked_localization.slip import SlipEstimator, unknown_slip
from tracked_localization.standstill import Standstill
from tracked_types import ImuSample, Odometry, PeriodGrid, Pose2, Slip, TrackSample, seconds_between

_IMU, _TRACKS = 0, 1
_SENSORS = (IMU, TRACKS)
_LOSSY_SHARE = 0.25
_ORIGIN = Pose2(0.0, 0.0, 0.0)


class OdometryFilter:
    """Fuses samples in the order of their stamps and gives an `Estimate` at every instant of the odometry grid.

    Samples may come late (within the patience), twice, out of order, or be nonsense: they are put in
    order, counted or refused, and `health` names the sensor. With one sensor gone the estimate goes on
    with growing covariance; with both gone it does not advance. When the clock jumps, the pose stays.
    """

    def __init__(self, settings: OdometryFilterSettings) -> None:
        self._settings = settings
        self._filter = PoseFilter(settings)
        self._buffer = SampleBuffer(
            (settings.imu_rate_hz, settings.tracks_rate_hz), settings.patience_s, settings.silence_s
        )
        self._grid = PeriodGrid(settings.tracks_rate_hz)
        self._gyro = GyroGate(settings)
        self._belts = BeltPair(settings)
        self._gyro_record = GyroRecord()
        self._standstill = Standstill(settings)
        self._slip_estimator = SlipEstimator(settings.slip)
        self._blames = BlameList(settings.blame_hold_s)
        self._innovations: deque[Innovation] = deque(maxlen=64)
        self._time_ns: int | None = None
        self._emitted_ns: int | None = None
        self._jumped_ns: int | None = None
        self._forget_inputs()

    @property
    def odometry(self) -> Odometry | None:
        """State at the stamp of the last fused sample or emitted estimate; None before the first sample."""
        return None if self._time_ns is None else self._filter.odometry(self._time_ns)

    @property
    def gyro_bias_radps(self) -> float:
        """Estimated bias of the gyro about the vertical."""
        return self._filter.gyro_bias_radps

    @property
    def standing(self) -> bool:
        """Whether the robot is at rest: the pose is frozen and the gyro's bias is being learnt."""
        return self._standstill.standing

    @property
    def health(self) -> Health:
        """State of the inputs at the newest stamp seen."""
        return self.health_at(self._buffer.newest_ns or 0)

    def health_at(self, now_ns: int) -> Health:
        """State of the inputs at ``now_ns``, which may be later than every stamp: then all have gone silent."""
        newest = self._buffer.newest_ns
        culprits = self._blames.culprits(now_ns)
        silent = newest is not None and seconds_between(now_ns, newest) > self._settings.silence_s
        if silent and newest is not None:
            known = {culprit.sensor for culprit in culprits if culprit.fault is Fault.SILENT}
            lost = [Culprit(name, Fault.SILENT, newest, now_ns) for name in _SENSORS if name not in known]
            culprits = (*lost, *culprits)
        advancing = newest is not None and not silent and not (self._imu_fails and self._tracks_fail)
        return Health(now_ns, culprits, dict(self._blames.counts), advancing, self.standing)

    def drain_innovations(self) -> list[Innovation]:
        """Innovations of the samples fused since the last call, at most the latest 64."""
        drained = list(self._innovations)
        self._innovations.clear()
        return drained

    def add_imu(self, sample: ImuSample) -> list[Estimate]:
        """Take in a sample; estimates for the instants that it completes."""
        return self._add(_IMU, sample.stamp_ns, sample)

    def add_tracks(self, sample: TrackSample) -> list[Estimate]:
        """Take in a sample; estimates for the instants that it completes."""
        return self._add(_TRACKS, sample.stamp_ns, sample)

    def reset(self, pose: Pose2 | None = None) -> None:
        """Put the robot at ``pose`` (the origin by default), surely known; the gyro's bias is kept."""
        self._filter.restart(pose or _ORIGIN)
        self._filter.rebase_rolled()
        self._rolled_m = self._filter.rolled_m

    def _add(self, index: int, stamp_ns: int, sample: ImuSample | TrackSample) -> list[Estimate]:
        arrival = self._buffer.add(index, stamp_ns, sample)
        if arrival is Arrival.TIME_JUMPED:
            self._resume()
        elif arrival in (Arrival.DUPLICATE, Arrival.LATE, Arrival.HELD):
            self._blames.count(_SENSORS[index], arrival.name.lower())
        elif arrival is Arrival.QUEUED_AFTER_GARBAGE and not self._jumped_lately(stamp_ns):
            self._blames.blame(_SENSORS[index], Fault.BAD_STAMP, stamp_ns)
        estimates: list[Estimate] = []
        for item in self._buffer.release():
            estimates.extend(self._instants_before(item.stamp_ns))
            self._fuse(item)
        self._watch_silence()
        released_ns = self._buffer.released_ns
        if released_ns is not None and self._time_ns is not None:
            estimates.extend(self._instants_before(released_ns + 1))
        return estimates

    def _instants_before(self, stamp_ns: int) -> Iterator[Estimate]:
        """Advance over the grid instants before ``stamp_ns`` that are still due."""
        if self._emitted_ns is None:
            self._emitted_ns = stamp_ns - 1
        for index in self._grid.crossed(self._emitted_ns, stamp_ns - 1):
            instant_ns = self._grid.stamp_ns(index)
            self._advance(instant_ns)
            self._emitted_ns = instant_ns
            yield Estimate(self._filter.odometry(instant_ns), self._slip_at(instant_ns))

    def _advance(self, stamp_ns: int) -> float:
        """Predict to ``stamp_ns``; the time passed (s)."""
        if self._time_ns is None:
            self._time_ns = self._start_ns = stamp_ns
        duration = seconds_between(stamp_ns, self._time_ns)
        if duration <= 0.0:
            return 0.0
        self._time_ns = stamp_ns
        if self._standstill.standing or (self._imu_fails and self._tracks_fail):
            self._filter.stand(duration)
        else:
            self._filter.predict(duration, belts_fail=self._tracks_fail, gyro_fails=self._imu_fails)
        return duration

    def _fuse(self, item: Ready) -> None:
        self._advance(item.stamp_ns)
        if item.stream == _IMU:
            self._fuse_imu(cast(ImuSample, item.sample))
        else:
            self._fuse_tracks(cast(TrackSample, item.sample))

    def _fuse_imu(self, sample: ImuSample) -> None:
        stamp_ns = sample.stamp_ns
        expected, variance = self._filter.expect_gyro()
        reading = self._gyro.update(sample, expected, variance, self._belt_yaw_rate(stamp_ns))
        self._gyro_record.add(stamp_ns, reading.rate_radps)
        if reading.fault is not None:
            self._blames.blame(IMU, reading.fault, stamp_ns)
        self._standstill.add_gyro(stamp_ns, reading.rate_radps, self._filter.gyro_bias_radps)
        self._check_steady_rate(stamp_ns)
        if reading.rate_radps is None:
            return
        duration = seconds_between(stamp_ns, self._gyro_ns) if self._gyro_ns is not None else 0.0
        self._gyro_ns = stamp_ns
        if self.standing and not self._bias_hopeless:
            self._innovations.append(self._filter.update_gyro(reading.rate_radps, stamp_ns, duration, standing=True))
        elif not self.standing:
            self._innovations.append(self._filter.update_gyro(reading.rate_radps, stamp_ns, duration, standing=False))

    def _check_steady_rate(self, stamp_ns: int) -> None:
        """At rest the gyro shows its bias; a bias that is not the one known is a fault of the gyro."""
        rate = self._standstill.steady_rate_radps
        if rate is None:
            return
        self._bias_hopeless = abs(rate) > self._settings.gyro_bias_limit_radps
        surprise = rate - self._filter.gyro_bias_radps
        plausible = self._filter.gyro_bias_variance + self._settings.gyro_noise_radps**2 / 4.0
        if self._bias_hopeless or surprise * surprise > self._settings.gate_chi_square * plausible:
            self._blames.blame(IMU, Fault.BIASED, stamp_ns)
            self._filter.doubt_bias()

    def _fuse_tracks(self, sample: TrackSample) -> None:
        stamp_ns, settings = sample.stamp_ns, self._settings
        last_ns, self._tracks_ns = self._tracks_ns, stamp_ns
        turning = self._gyro_record.mean(last_ns, stamp_ns) if last_ns is not None else None
        yaw_rate = turning[0] - self._filter.gyro_bias_radps if turning is not None else None
        motion = self._belts.update(sample, yaw_rate)
        for sensor, fault in motion.faults:
            self._blames.blame(sensor, fault, stamp_ns)
        self._standstill.add_belts(motion)
        if last_ns is None or motion.duration_s <= 0.0:
            return
        self._roll(motion)
        belt_rate = motion.yaw_rate_radps(settings.gauge_m)
        if belt_rate is not None:
            self._belt_rate = (stamp_ns, belt_rate)
            if self._imu_fails and not self.standing:
                deviation = settings.belt_yaw_ratio_deviation * abs(belt_rate) + settings.gyro_noise_radps
                self._filter.update_yaw_rate(settings.belt_yaw_ratio * belt_rate, deviation**2 + 1e-4)
        if motion.left_m is None or motion.right_m is None or turning is None or yaw_rate is None:
            self._slip = unknown_slip(stamp_ns)
            return
        self._slip = self._slip_estimator.update(
            stamp_ns,
            motion.left_m / motion.duration_s,
            motion.right_m / motion.duration_s,
            yaw_rate,
            settings.gyro_noise_radps**2 / turning[1] + self._filter.gyro_bias_variance,
            motion.duration_s,
        )

    def _roll(self, motion: BeltMotion) -> None:
        """Fuse the forward travel, from both belts or, with the gyro's help, from one."""
        forward, variance = self._forward(motion)
        if forward is None:
            self._filter.rebase_rolled()
            self._rolled_m = self._filter.rolled_m
            return
        self._rolled_ns = motion.stamp_ns
        self._rolled_m += forward
        if self.standing:
            self._rolled_m = self._filter.rolled_m
            return
        self._innovations.append(
            self._filter.update_rolled(self._rolled_m, variance, motion.stamp_ns, motion.duration_s)
        )

    def _forward(self, motion: BeltMotion) -> tuple[float | None, float]:
        settings = self._settings
        if motion.left_m is not None and motion.right_m is not None:
            return 0.5 * (motion.left_m + motion.right_m), 0.0
        if motion.left_m is None and motion.right_m is None:
            return None, 0.0
        turn = self._filter.odometry(motion.stamp_ns).twist.yaw_rate_radps * motion.duration_s / settings.belt_yaw_ratio
        half = 0.5 * settings.gauge_m * turn
        deviation = half * settings.belt_yaw_ratio_deviation / settings.belt_yaw_ratio + settings.encoder_tick_m
        if motion.left_m is not None:
            return motion.left_m + half, deviation**2
        return cast(float, motion.right_m) - half, deviation**2

    def _belt_yaw_rate(self, now_ns: int) -> float | None:
        if self._belt_rate is None or seconds_between(now_ns, self._belt_rate[0]) > self._settings.silence_s:
            return None
        return self._belt_rate[1]

    def _slip_at(self, instant_ns: int) -> Slip:
        if seconds_between(instant_ns, self._slip.stamp_ns) > self._settings.silence_s:
            return unknown_slip(instant_ns)
        slip = self._slip
        return Slip(
            instant_ns, slip.speed_mps, slip.yaw_rate_radps, slip.speed_variance, slip.yaw_rate_variance, slip.known
        )

    def _watch_silence(self) -> None:
        now_ns = self._buffer.newest_ns
        if now_ns is None or self._time_ns is None:
            return
        for index, sensor in enumerate(_SENSORS):
            if self._buffer.silent(index):
                self._blames.keep_blaming(sensor, Fault.SILENT, now_ns)
            elif self._buffer.loss(index) > _LOSSY_SHARE:
                self._blames.keep_blaming(sensor, Fault.LOSSY, now_ns)

    @property
    def _imu_fails(self) -> bool:
        return self._unheard(self._gyro_ns)

    @property
    def _tracks_fail(self) -> bool:
        return self._unheard(self._rolled_ns)

    def _unheard(self, credible_ns: int | None) -> bool:
        """Whether a sensor has said nothing credible for too long."""
        if self._time_ns is None:
            return False
        since_ns = self._start_ns if credible_ns is None else credible_ns
        return since_ns is not None and seconds_between(self._time_ns, since_ns) > self._settings.silence_s

    def _jumped_lately(self, stamp_ns: int) -> bool:
        return self._jumped_ns is not None and abs(seconds_between(stamp_ns, self._jumped_ns)) < 1.0

    def _resume(self) -> None:
        """A new time line begins: after a short gap go on, else stop where the robot is."""
        start_ns = cast(int, self._buffer.released_ns)
        gap = seconds_between(start_ns, self._time_ns) if self._time_ns is not None else 0.0
        self._jumped_ns = start_ns
        if 0.0 <= gap <= self._settings.bridged_gap_s:
            return
        if self._time_ns is not None:
            self._blames.shift(start_ns - self._time_ns)
        self._blames.count("clock", "jumped")
        self._filter.interrupt(abs(gap))
        self._gyro.restart()
        self._belts.restart()
        self._gyro_record.clear()
        self._standstill.restart()
        self._time_ns = self._emitted_ns = start_ns
        self._forget_inputs()

    def _forget_inputs(self) -> None:
        self._start_ns = self._time_ns
        self._gyro_ns: int | None = None
        self._tracks_ns: int | None = None
        self._rolled_ns: int | None = None
        self._rolled_m = self._filter.rolled_m
        self._belt_rate: tuple[int, float] | None = None
        self._slip = unknown_slip(0)
        self._bias_hopeless = False
