"""A slipping track pair without physics: smooth belt speeds, a gyro and two counters, all seeded."""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np
import pytest

from tracked_description import Robot, load_robot
from tracked_localization import OdometryFilter, OdometryFilterSettings
from tracked_types import ImuSample, Pose2, Slip, TrackSample, Twist2, wrap_angle

SUBSTEPS = 4
LOST_SHARE = 0.01
"""Of the belts' travel, on even ground."""


@dataclass(frozen=True)
class Tick:
    """One IMU period of truth and sensors; tracks come with every second one."""

    stamp_ns: int
    imu: ImuSample
    tracks: TrackSample | None
    pose: Pose2
    twist: Twist2
    slip: Slip

    @property
    def samples(self) -> list[ImuSample | TrackSample]:
        """What the sensors say in it."""
        return [self.imu] if self.tracks is None else [self.imu, self.tracks]


def wandering(seed: int) -> Callable[[float], tuple[float, float]]:
    """Rest, then cruising, curves, spot turns and stops of a second or two."""
    random = np.random.default_rng(seed)
    ends, targets = [1.0], [(0.0, 0.0)]
    while ends[-1] < 60.0:
        kind = random.choice(["stop", "straight", "curve", "spot turn"])
        speed = float(random.uniform(-0.3, 0.5)) if kind in ("straight", "curve") else 0.0
        rate = float(random.uniform(-1.3, 1.3)) if kind in ("curve", "spot turn") else 0.0
        ends.append(ends[-1] + float(random.uniform(0.8, 2.0)))
        targets.append((speed, rate))
    return lambda time_s: targets[int(np.searchsorted(ends, time_s, side="right"))]


class SyntheticCrawler:
    """Belts follow ramped commands with a lag; the body turns ``yaw_ratio`` times as fast, and slides outwards."""

    def __init__(self, robot: Robot, drive, seed: int = 0, *, yaw_ratio: float = 0.8, slide_s: float = 0.18) -> None:
        self._robot, self._drive, self._yaw_ratio, self._slide_s = robot, drive, yaw_ratio, slide_s
        self._random = np.random.default_rng(seed)
        self._command = np.zeros(2)
        self._belts = np.zeros(2)
        self._travel = self._random.uniform(0.0, 1.0, 2)
        self._ticks = np.floor(self._travel / robot.tracks.encoder_tick_m)
        self._time_s = 0.0
        self._pose = Pose2(0.0, 0.0, 0.0)
        self.bias_radps = robot.imu.gyro_bias_radps

    def run(self, duration_s: float, offset_s: float = 0.0) -> Iterator[Tick]:
        """Ticks of the next ``duration_s``, stamped ``offset_s`` later than they happen."""
        rate_hz = self._robot.imu.rate_hz
        first = round(self._time_s * rate_hz) + 1
        for index in range(first, first + round(duration_s * rate_hz)):
            self._time_s = index / rate_hz
            stamp_ns = round((self._time_s + offset_s) * 1e9)
            before = self._pose.yaw_rad
            twist = self._move()
            turn = wrap_angle(self._pose.yaw_rad - before)
            tracks = self._count(stamp_ns) if index % 2 == 0 else None
            yield Tick(
                stamp_ns, self._imu(stamp_ns, turn * rate_hz), tracks, self._pose, twist, self._true_slip(stamp_ns)
            )

    def _move(self) -> Twist2:
        robot, step = self._robot, 1.0 / self._robot.imu.rate_hz / SUBSTEPS
        reach = np.array([robot.limits.acceleration_mps2, robot.limits.yaw_acceleration_radps2]) * step * SUBSTEPS
        self._command += np.clip(np.array(self._drive(self._time_s)) - self._command, -reach, reach)
        half = 0.5 * robot.tracks.gauge_m * self._command[1]
        targets = self._command[0] + np.array([-half, half])
        for _ in range(SUBSTEPS):
            self._belts = self._belts + (targets - self._belts) * step / robot.tracks.motor_time_constant_s
            self._travel = self._travel + self._belts * step
            twist = self._ground_twist()
            slip_angle = self._slide_s * twist.yaw_rate_radps
            direction = self._pose.yaw_rad + 0.5 * twist.yaw_rate_radps * step - slip_angle
            reach = twist.speed_mps * step / math.cos(slip_angle)
            self._pose = Pose2(
                self._pose.x_m + reach * math.cos(direction),
                self._pose.y_m + reach * math.sin(direction),
                wrap_angle(self._pose.yaw_rad + twist.yaw_rate_radps * step),
            )
        return self._ground_twist()

    def _ground_twist(self) -> Twist2:
        left, right = self._belts.tolist()
        belt_rate = (right - left) / self._robot.tracks.gauge_m
        return Twist2(0.5 * (left + right) * (1.0 - LOST_SHARE), belt_rate * self._yaw_ratio)

    def _true_slip(self, stamp_ns: int) -> Slip:
        left, right = self._belts.tolist()
        twist, belt_rate = self._ground_twist(), (right - left) / self._robot.tracks.gauge_m
        speed, rate = twist.speed_mps - 0.5 * (left + right), twist.yaw_rate_radps - belt_rate
        return Slip(stamp_ns, speed, rate, 0.0, 0.0, known=True)

    def _count(self, stamp_ns: int) -> TrackSample:
        tick_m = self._robot.tracks.encoder_tick_m
        ticks = np.floor(self._travel / tick_m)
        moved, self._ticks = ticks - self._ticks, ticks
        return TrackSample(
            stamp_ns, *(ticks * tick_m).tolist(), *(moved * tick_m * self._robot.odometry.rate_hz).tolist()
        )

    def _imu(self, stamp_ns: int, rate: float) -> ImuSample:
        imu = self._robot.imu
        return ImuSample(
            stamp_ns,
            "imu_link",
            np.array([0.0, 0.0, rate + self.bias_radps]) + imu.gyro_noise_radps * self._random.standard_normal(3),
            np.array([0.0, 0.0, 9.81]) + imu.acceleration_noise_mps2 * self._random.standard_normal(3),
            np.eye(3) * imu.gyro_noise_radps**2,
            np.eye(3) * imu.acceleration_noise_mps2**2,
        )


@pytest.fixture(scope="session")
def robot() -> Robot:
    return load_robot()


@pytest.fixture(scope="session")
def settings(robot) -> OdometryFilterSettings:
    return OdometryFilterSettings.from_robot(robot)


@pytest.fixture
def odometry_filter(settings) -> OdometryFilter:
    return OdometryFilter(settings)


@pytest.fixture(scope="session")
def drives() -> SimpleNamespace:
    """Commands (m/s, rad/s) by time."""
    return SimpleNamespace(
        rest=lambda _time_s: (0.0, 0.0),
        straight=lambda _time_s: (0.35, 0.0),
        curve=lambda _time_s: (0.35, 0.4),
        spot_turn=lambda _time_s: (0.0, 1.0),
        wandering=wandering,
    )


@pytest.fixture(scope="session")
def crawler(robot) -> Callable[..., SyntheticCrawler]:
    """Maker of a synthetic robot that follows a drive."""
    return lambda drive, seed=0, **options: SyntheticCrawler(robot, drive, seed, **options)


@pytest.fixture(scope="session")
def feed() -> Callable:
    """``feed(filter, ticks, corrupt)``: estimates; ``corrupt(tick)`` gives the samples that arrive instead."""

    def run(odometry_filter: OdometryFilter, ticks, corrupt=lambda tick: tick.samples) -> list:
        estimates = []
        for tick in ticks:
            for sample in corrupt(tick):
                add = odometry_filter.add_imu if isinstance(sample, ImuSample) else odometry_filter.add_tracks
                estimates += add(sample)
        return estimates

    return run
