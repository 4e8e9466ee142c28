"""Odometry of a slipping tracked robot from belt counters and a gyro."""

from collections.abc import Iterator
from dataclasses import replace
from typing import cast

from tracked_localization.estimate import Estimate
from tracked_localization.fusion import SensorFusion
from tracked_localization.health import IMU, TRACKS, BlameList, Culprit, Fault, Health
from tracked_localization.innovation import Innovation
from tracked_localization.sample_buffer import Arrival, Ready, SampleBuffer
from tracked_localization.settings import OdometryFilterSettings
from tracked_localization.tilt import Tilt
from tracked_types import ImuSample, Odometry, PeriodGrid, Pose2, PoseSample, TrackSample, seconds_between

_IMU, _TRACKS = 0, 1
_SENSORS = (IMU, TRACKS)
_LOSSY_SHARE = 0.25
_IN_FLIGHT_S = 1.0
_ORIGIN = Pose2(0.0, 0.0, 0.0)


class OdometryFilter:
    """Fuses samples in the order of their stamps and gives an `Estimate` at every instant of the odometry grid.

    Samples may come late (within the patience), twice, out of order, or be nonsense: they are put in
    order, counted or refused, and `health` names the sensor. With one sensor gone the estimate goes on
    with growing covariance; with both gone it does not advance. When the clock jumps, the pose stays.
    """

    def __init__(self, settings: OdometryFilterSettings) -> None:
        self._settings = settings
        self._blames = BlameList(settings.blame_hold_s)
        self._fusion = SensorFusion(settings, self._blames)
        self._buffer = SampleBuffer(
            (settings.imu_rate_hz, settings.tracks_rate_hz), settings.patience_s, settings.silence_s
        )
        self._grid = PeriodGrid(settings.tracks_rate_hz)
        self._tilt = Tilt(settings.imu_rpy_rad)
        self._next_index: int | None = None
        self._jumped_ns: int | None = None

    @property
    def odometry(self) -> Odometry | None:
        """State at the stamp of the last fused sample or estimate; None before the first sample."""
        time_ns = self._fusion.time_ns
        return None if time_ns is None else self._fusion.odometry(time_ns)

    @property
    def gyro_bias_radps(self) -> float:
        """Estimated bias of the gyro about the vertical."""
        return self._fusion.gyro_bias_radps

    @property
    def standing(self) -> bool:
        """Whether the robot is at rest: the pose is frozen and the gyro's bias is being learnt."""
        return self._fusion.standing

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
        blind = newest is None or silent or (self._fusion.imu_fails and self._fusion.tracks_fail)
        return Health(now_ns, culprits, dict(self._blames.counts), advancing=not blind, standing=self.standing)

    def drain_innovations(self) -> list[Innovation]:
        """Innovations of the samples fused since the last call, at most the latest 64."""
        drained = list(self._fusion.innovations)
        self._fusion.innovations.clear()
        return drained

    def add_imu(self, sample: ImuSample) -> list[Estimate]:
        """Take in a sample; estimates for the instants that it completes."""
        return self._add(_IMU, sample.stamp_ns, sample)

    def add_tracks(self, sample: TrackSample) -> list[Estimate]:
        """Take in a sample; estimates for the instants that it completes."""
        return self._add(_TRACKS, sample.stamp_ns, sample)

    def expect_poses(self) -> None:
        """Be ready for measured poses; without this the first one that comes is only the announcement of others."""
        self._fusion.expect_poses()

    def add_pose(self, sample: PoseSample) -> list[Estimate]:
        """Take in a measured pose in the odometry's frame, however late within the patience; it completes no instant.

        What it says of its own instant corrects the estimates from now on, as if it had come in time.
        """
        self._fusion.fuse_pose(sample, self._buffer.newest_ns)
        return []

    def reset(self, pose: Pose2 | None = None) -> None:
        """Put the robot at ``pose`` (the origin by default), surely known; the gyro's bias is kept.

        Raises
        ------
        ValueError: if the pose is not finite.
        """
        target = pose or _ORIGIN
        if not abs(target.x_m) + abs(target.y_m) + abs(target.yaw_rad) < float("inf"):
            raise ValueError(f"the pose must be finite, got {target}")
        self._fusion.restart(target)

    def _add(self, index: int, stamp_ns: int, sample: ImuSample | TrackSample) -> list[Estimate]:
        self._note(index, stamp_ns, self._buffer.add(index, stamp_ns, sample))
        estimates: list[Estimate] = []
        for item in self._buffer.release():
            estimates.extend(self._instants_before(item.stamp_ns))
            self._fuse(item)
        if self._fusion.time_ns is not None:
            self._watch_silence()
            estimates.extend(self._instants_before(cast(int, self._buffer.released_ns) + 1))
        return estimates

    def _note(self, index: int, stamp_ns: int, arrival: Arrival) -> None:
        if arrival is Arrival.QUEUED:
            return
        if arrival is Arrival.TIME_JUMPED:
            self._resume()
        elif arrival is not Arrival.QUEUED_AFTER_GARBAGE:
            self._blames.count(_SENSORS[index], arrival.name.lower())
        elif self._jumped_ns is None or abs(seconds_between(stamp_ns, self._jumped_ns)) > _IN_FLIGHT_S:
            # Just after a jump it is only a sample from before it.
            self._blames.blame(_SENSORS[index], Fault.BAD_STAMP, stamp_ns)

    def _fuse(self, item: Ready) -> None:
        self._fusion.advance(item.stamp_ns)
        if item.stream == _IMU:
            self._fusion.fuse_imu(cast(ImuSample, item.sample))
            self._tilt.add(cast(ImuSample, item.sample))
        else:
            self._fusion.fuse_tracks(cast(TrackSample, item.sample))

    def _instants_before(self, stamp_ns: int) -> Iterator[Estimate]:
        """Advance over the grid instants before ``stamp_ns`` that are still due."""
        if self._next_index is None:
            self._next_index = self._grid.index_at(stamp_ns - 1) + 1
        while (instant_ns := self._grid.stamp_ns(self._next_index)) < stamp_ns:
            self._next_index += 1
            self._fusion.advance(instant_ns)
            self._fusion.remember(instant_ns)
            odometry = self._fusion.odometry(instant_ns)
            tilted = replace(odometry, roll_rad=self._tilt.roll_rad, pitch_rad=self._tilt.pitch_rad)
            yield Estimate(tilted, self._fusion.slip(instant_ns))

    def _watch_silence(self) -> None:
        for index, sensor in enumerate(_SENSORS):
            if self._buffer.silent(index):
                self._blames.keep_blaming(sensor, Fault.SILENT, cast(int, self._buffer.newest_ns))
            elif self._buffer.loss(index) > _LOSSY_SHARE:
                self._blames.keep_blaming(sensor, Fault.LOSSY, cast(int, self._buffer.newest_ns))

    def _resume(self) -> None:
        """A new time line begins: after a short gap go on, else stop where the robot is."""
        start_ns = self._jumped_ns = cast(int, self._buffer.released_ns)
        time_ns = self._fusion.time_ns
        if time_ns is None:
            return
        gap = seconds_between(start_ns, time_ns)
        if 0.0 <= gap <= self._settings.bridged_gap_s:
            return
        self._blames.shift(start_ns - time_ns)
        self._blames.count("clock", "jumped")
        self._fusion.interrupt(start_ns, abs(gap))
        self._next_index = self._grid.index_at(start_ns) + 1
