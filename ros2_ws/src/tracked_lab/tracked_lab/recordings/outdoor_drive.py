"""Six minutes of a real Husky outdoors: IMU, wheel odometry and GPS as samples of the stack."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from tracked_lab.recordings.recording_file import Array, RecordingError, load_arrays
from tracked_types import ImuSample, TrackSample, to_nanoseconds

_FIELDS = ("imu_t", "gyro_base", "accel_base", "odom_t", "odom_pose_xy_yaw", "gps_t", "gps_enu_xy")
_START_S = 1.0
"""Stamp of the recording's beginning: the first samples must not lie before zero."""


@dataclass(frozen=True, slots=True)
class OutdoorDrive:
    """Times (s) from the beginning on.

    imu_s (n,), gyro_radps and acceleration_mps2 (n, 3) in the base. wheels_s (m,), left_m and right_m (m,): travel
    of the wheels. gps_s (k,), gps_m (k, 2): east and north of the first fix.
    """

    imu_s: Array
    gyro_radps: Array
    acceleration_mps2: Array
    wheels_s: Array
    left_m: Array
    right_m: Array
    gps_s: Array
    gps_m: Array

    @property
    def travel_m(self) -> float:
        """Distance driven, by the wheels."""
        return float(np.abs(np.diff(0.5 * (self.left_m + self.right_m))).sum())

    @property
    def duration_s(self) -> float:
        """Time from the first to the last wheel sample."""
        return float(self.wheels_s[-1] - self.wheels_s[0])

    def samples(self) -> Iterator[ImuSample | TrackSample]:
        """All samples in the order of their stamps, as drivers would publish them."""
        unknown = np.zeros((3, 3))
        times = np.concatenate([self.imu_s, self.wheels_s])
        for place in np.argsort(times, kind="stable"):
            stamp_ns, index = to_nanoseconds(_START_S + float(times[place])), int(place)
            if index < len(self.imu_s):
                yield ImuSample(
                    stamp_ns, "imu_link", self.gyro_radps[index], self.acceleration_mps2[index], unknown, unknown
                )
            else:
                index -= len(self.imu_s)
                yield TrackSample(stamp_ns, float(self.left_m[index]), float(self.right_m[index]))


def seconds_of(stamp_ns: int) -> float:
    """Time in the recording of a stamp of `OutdoorDrive.samples`."""
    return stamp_ns * 1e-9 - _START_S


def load_outdoor_drive(gauge_m: float, encoder_tick_m: float, path: Path | None = None) -> OutdoorDrive:
    """Read the recording; wheel travel is taken back from the odometry's pose, by the gauge that made it.

    Raises
    ------
    RecordingError: if the file cannot be used.
    """
    fields = load_arrays("husky_outdoor_imu_odom_gps", _FIELDS, path)
    for name in ("imu_t", "odom_t", "gps_t"):
        if fields[name].ndim != 1 or len(fields[name]) < 2 or not (np.diff(fields[name]) > 0.0).all():
            raise RecordingError(f"husky_outdoor_imu_odom_gps.npz: {name} does not increase")
    left, right = wheel_travel(fields["odom_pose_xy_yaw"], gauge_m, encoder_tick_m)
    return OutdoorDrive(
        imu_s=fields["imu_t"],
        gyro_radps=fields["gyro_base"],
        acceleration_mps2=fields["accel_base"],
        wheels_s=fields["odom_t"],
        left_m=left,
        right_m=right,
        gps_s=fields["gps_t"],
        gps_m=fields["gps_enu_xy"],
    )


def wheel_travel(poses: Array, gauge_m: float, tick_m: float) -> tuple[Array, Array]:
    """Travel (m,) of both wheels that a differential drive's odometry (m, 3: x, y, yaw) was integrated from."""
    turn = np.diff(np.unwrap(poses[:, 2]))
    heading = np.unwrap(poses[:, 2])[:-1] + 0.5 * turn
    step = np.diff(poses[:, :2], axis=0)
    chord = step[:, 0] * np.cos(heading) + step[:, 1] * np.sin(heading)
    arc = chord / np.sinc(0.5 * turn / np.pi)
    left, right = arc - 0.5 * gauge_m * turn, arc + 0.5 * gauge_m * turn

    def counted(steps: Array) -> Array:
        return np.concatenate([[0.0], np.cumsum(np.round(steps / tick_m))]) * tick_m

    return counted(left), counted(right)
