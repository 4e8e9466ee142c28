"""A slipping track pair without physics, for tests: smooth random belt speeds, a gyro and two counters."""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from tracked_description import Robot
from tracked_types import ImuSample, Pose2, Slip, TrackSample, Twist2, wrap_angle

Drive = Callable[[float], tuple[float, float]]
_SUBSTEPS = 4


@dataclass(frozen=True)
class Tick:
    """One 1/120 s of the truth and of the sensors; ``tracks`` comes with every second one."""

    stamp_ns: int
    imu: ImuSample
    tracks: TrackSample | None
    pose: Pose2
    twist: Twist2
    slip: Slip


def standing(_time_s: float) -> tuple[float, float]:
    """Do nothing."""
    return 0.0, 0.0


def straight(_time_s: float) -> tuple[float, float]:
    """Drive on at 0.35 m/s."""
    return 0.35, 0.0


def wandering(seed: int) -> Drive:
    """Random targets (m/s, rad/s), a new one each second or two: cruising, curves, spot turns and stops."""
    rng = np.random.default_rng(seed)
    plan: list[tuple[float, float, float]] = []
    until = 0.0
    while until < 120.0:
        until += float(rng.uniform(0.8, 2.0))
        kind = rng.integers(0, 4)
        speed = 0.0 if kind in (0, 3) else float(rng.uniform(-0.3, 0.5))
        rate = 0.0 if kind in (0, 1) else float(rng.uniform(-1.3, 1.3))
        plan.append((until, speed, rate))
    return lambda time: next((v, w) for end, v, w in plan if time < end)


class SyntheticCrawler:
    """Belts follow the drive with a lag and a limit; the body turns by ``yaw_ratio`` of what the belts ask for."""

    def __init__(self, robot: Robot, drive: Drive, seed: int, *, yaw_ratio: float = 0.8, slip: float = 0.01) -> None:
        self._robot = robot
        self._drive = drive
        self._rng = np.random.default_rng(seed)
        self._yaw_ratio = yaw_ratio
        self._slip = slip
        self._belts = np.zeros(2)
        self._travel = self._rng.uniform(0.0, 1.0, 2)
        self._counted = self._ticks()
        self._pose = Pose2(0.0, 0.0, 0.0)
        self.bias_radps = robot.imu.gyro_bias_radps

    def run(self, duration_s: float, start_s: float = 0.0) -> Iterator[Tick]:
        """Ticks over ``duration_s``; stamps begin at ``start_s``."""
        robot = self._robot
        for index in range(1, round(duration_s * robot.imu.rate_hz) + 1):
            time = index / robot.imu.rate_hz
            stamp_ns = round((start_s + time) * 1e9)
            before = self._pose.yaw_rad
            twist = self._move(time)
            rate = wrap_angle(self._pose.yaw_rad - before) * robot.imu.rate_hz
            tracks = self._count(stamp_ns) if index % 2 == 0 else None
            yield Tick(stamp_ns, self._imu(stamp_ns, rate), tracks, self._pose, twist, self._true_slip(stamp_ns, twist))

    def _move(self, time: float) -> Twist2:
        robot = self._robot
        step = 1.0 / robot.imu.rate_hz / _SUBSTEPS
        speed, rate = self._drive(time)
        half = 0.5 * robot.tracks.gauge_m
        targets = np.array([speed - half * rate, speed + half * rate])
        limit = robot.tracks.acceleration_limit_mps2 * step
        for _ in range(_SUBSTEPS):
            self._belts += np.clip((targets - self._belts) * step / robot.tracks.motor_time_constant_s, -limit, limit)
            self._travel += self._belts * step
            twist = self._ground_twist()
            turn = twist.yaw_rate_radps * step
            middle = self._pose.yaw_rad + 0.5 * turn
            self._pose = Pose2(
                self._pose.x_m + twist.speed_mps * step * math.cos(middle),
                self._pose.y_m + twist.speed_mps * step * math.sin(middle),
                wrap_angle(self._pose.yaw_rad + turn),
            )
        return self._ground_twist()

    def _ground_twist(self) -> Twist2:
        left, right = self._belts
        return Twist2(
            float(0.5 * (left + right) * (1.0 - self._slip)),
            float((right - left) / self._robot.tracks.gauge_m * self._yaw_ratio),
        )

    def _true_slip(self, stamp_ns: int, twist: Twist2) -> Slip:
        left, right = self._belts
        return Slip(
            stamp_ns,
            float(twist.speed_mps - 0.5 * (left + right)),
            float(twist.yaw_rate_radps - (right - left) / self._robot.tracks.gauge_m),
            0.0,
            0.0,
            known=True,
        )

    def _ticks(self) -> np.ndarray:
        return np.floor(self._travel / self._robot.tracks.encoder_tick_m)

    def _count(self, stamp_ns: int) -> TrackSample:
        ticks = self._ticks()
        moved, self._counted = ticks - self._counted, ticks
        left, right = (float(value) for value in ticks * self._robot.tracks.encoder_tick_m)
        speeds = moved * self._robot.tracks.encoder_tick_m * self._robot.odometry.rate_hz
        return TrackSample(stamp_ns, left, right, float(speeds[0]), float(speeds[1]))

    def _imu(self, stamp_ns: int, rate: float) -> ImuSample:
        imu = self._robot.imu
        return ImuSample(
            stamp_ns=stamp_ns,
            frame_id="imu_link",
            angular_velocity_radps=np.array([0.0, 0.0, rate + self.bias_radps])
            + imu.gyro_noise_radps * self._rng.standard_normal(3),
            linear_acceleration_mps2=np.array([0.0, 0.0, 9.81])
            + imu.acceleration_noise_mps2 * self._rng.standard_normal(3),
            angular_velocity_covariance=np.eye(3) * imu.gyro_noise_radps**2,
            linear_acceleration_covariance=np.eye(3) * imu.acceleration_noise_mps2**2,
        )
