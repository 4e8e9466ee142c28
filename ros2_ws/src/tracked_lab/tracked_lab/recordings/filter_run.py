"""The whole odometry filter on a recorded drive: track, refusals, and what it learns of the gyro's bias."""

from collections import defaultdict
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from tracked_lab.recordings.outdoor_drive import OutdoorDrive, seconds_of
from tracked_lab.recordings.recording_file import Array
from tracked_localization import OdometryFilter, OdometryFilterSettings
from tracked_types import ImuSample


@dataclass(frozen=True, slots=True)
class FilterRun:
    """What the filter did.

    times_s (n,), positions_m (n, 2): its track. bias_s (k,), bias_radps (k,): estimated bias of the gyro.
    offences: refused samples and the like, by sensor and fault. longest_deaf_s: longest time, by sensor, over which
    the moving filter took in nothing of it. nis: mean normalised squared innovation by sensor. rests_s: from when to
    when it stood.
    """

    times_s: Array
    positions_m: Array
    bias_s: Array
    bias_radps: Array
    offences: Mapping[str, int]
    longest_deaf_s: Mapping[str, float]
    nis: Mapping[str, float]
    rests_s: tuple[tuple[float, float], ...]

    def bias_at(self, time_s: float) -> float:
        """Estimated bias then."""
        return float(np.interp(time_s, self.bias_s, self.bias_radps))


@dataclass(slots=True)
class _Watch:
    """Collects what the filter shows from sample to sample."""

    heard_s: dict[str, float] = field(default_factory=dict)
    deaf_s: dict[str, float] = field(default_factory=lambda: defaultdict(float))
    nis: dict[str, list[float]] = field(default_factory=lambda: defaultdict(list))
    rests: list[tuple[float, float]] = field(default_factory=list)
    standing_since_s: float | None = None

    def look(self, estimator: OdometryFilter, now_s: float) -> None:
        """After each sample."""
        for innovation in estimator.drain_innovations():
            if not innovation.at_rest:
                self.nis[innovation.sensor].append(innovation.normalised_square)
            self._hears(innovation.sensor, seconds_of(innovation.stamp_ns))
        if estimator.standing:
            # At rest the pose is frozen, and wheels that do not turn have nothing to say.
            self.heard_s.update(dict.fromkeys(self.heard_s, now_s))
            self.standing_since_s = now_s if self.standing_since_s is None else self.standing_since_s
        elif self.standing_since_s is not None:
            self.rests.append((self.standing_since_s, now_s))
            self.standing_since_s = None

    def _hears(self, sensor: str, stamp_s: float) -> None:
        self.deaf_s[sensor] = max(self.deaf_s[sensor], stamp_s - self.heard_s.get(sensor, stamp_s))
        self.heard_s[sensor] = stamp_s


def run_filter(drive: OutdoorDrive, settings: OdometryFilterSettings) -> FilterRun:
    """Feed the recording, sample by sample."""
    estimator, watch = OdometryFilter(settings), _Watch()
    track: list[tuple[float, float, float]] = []
    bias: list[tuple[float, float]] = []
    now_s = 0.0
    for sample in drive.samples():
        now_s = seconds_of(sample.stamp_ns)
        imu = isinstance(sample, ImuSample)
        estimates = estimator.add_imu(sample) if isinstance(sample, ImuSample) else estimator.add_tracks(sample)
        for estimate in estimates:
            pose = estimate.odometry.pose
            track.append((seconds_of(estimate.odometry.stamp_ns), pose.x_m, pose.y_m))
        watch.look(estimator, now_s)
        if not imu:
            bias.append((now_s, estimator.gyro_bias_radps))
    if watch.standing_since_s is not None:
        watch.rests.append((watch.standing_since_s, now_s))
    tracked, biases = np.array(track), np.array(bias)
    return FilterRun(
        times_s=tracked[:, 0],
        positions_m=tracked[:, 1:],
        bias_s=biases[:, 0],
        bias_radps=biases[:, 1],
        offences=dict(estimator.health.counts),
        longest_deaf_s=dict(watch.deaf_s),
        nis={sensor: float(np.mean(values)) for sensor, values in watch.nis.items()},
        rests_s=tuple(watch.rests),
    )
