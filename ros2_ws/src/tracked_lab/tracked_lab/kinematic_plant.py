"""A slipping tracked robot in the plane, fast enough to tune controllers on.

Its ground is deliberately not the controllers' model: belts lag and are limited in acceleration, turning
loses yaw like a track pair with widened instantaneous centres of rotation, with a share that depends on the
turn and on slowly varying terrain; there is longitudinal slip, sideways skid and, for half a second, an
obstacle that takes the yaw rate over. Odometry is what dead reckoning makes of belt ticks and a gyro.
"""

import math
from collections import deque
from dataclasses import dataclass

import numpy as np

from tracked_description import Robot
from tracked_localization.estimate import Estimate
from tracked_localization.slip import SlipEstimator, SlipSettings
from tracked_types import (
    Odometry,
    PeriodGrid,
    Pose2,
    Twist2,
    VelocityCommand,
    seconds_between,
    to_nanoseconds,
    wrap_angle,
)

SUBSTEPS = 8  # of the period of the odometry
TERRAIN_CORRELATION_S = 0.5


@dataclass(frozen=True, slots=True, kw_only=True)
class Ground:
    """How the ground answers to the belts of one run.

    belt_lag_s: time constant of the belts. yaw_loss: belt yaw rate over ground yaw rate, less one, on
    wide turns and in addition on the spot. terrain: standard deviation of its slow variation.
    speed_loss: longitudinal slip. skid_m: sideways speed per yaw rate. kick_radps, kick_window_s: yaw rate
    forced by an obstacle and when. gyro_bias_radps: what is left of the gyro's bias.
    """

    belt_lag_s: float
    yaw_loss: float
    yaw_loss_on_spot: float
    terrain: float
    speed_loss: float
    skid_m: float
    kick_radps: float
    kick_window_s: tuple[float, float]
    gyro_bias_radps: float

    @classmethod
    def drawn(cls, generator: np.random.Generator, severity: float = 1.0, obstacle: bool = True) -> "Ground":
        """A ground at random; ``severity`` scales all slip, 0 is a ground without any."""
        kick = float(generator.choice([-1.0, 1.0]) * generator.uniform(0.5, 0.9))
        return cls(
            belt_lag_s=float(generator.uniform(0.05, 0.09)),
            yaw_loss=severity * float(generator.uniform(0.10, 0.20)),
            yaw_loss_on_spot=severity * float(generator.uniform(0.10, 0.30)),
            terrain=0.05 * severity,
            speed_loss=severity * float(generator.uniform(0.01, 0.05)),
            skid_m=severity * float(generator.uniform(0.0, 0.03)),
            kick_radps=kick if obstacle else 0.0,
            kick_window_s=(3.0, 3.5),
            gyro_bias_radps=float(generator.normal(0.0, 0.001)),
        )


@dataclass(frozen=True, slots=True)
class PlantSample:
    """What the plant shows at one instant of the odometry: an estimate, and the truth behind it."""

    estimate: Estimate
    truth: Pose2
    true_slip: Twist2


class KinematicPlant:
    """Advances by one period of the odometry at a time; equal seeds and commands give equal samples.

    Parameters
    ----------
    robot: gauge, encoder, limits and delays are its own.
    seed: of the ground and of all noise.
    ground: instead of the one that the seed would draw.
    start: true and estimated pose at stamp 0.
    """

    def __init__(self, robot: Robot, seed: int, ground: Ground | None = None, start: Pose2 | None = None) -> None:
        generator = np.random.default_rng(seed)
        drawn = Ground.drawn(generator)
        self.ground = ground or drawn
        self._generator = generator
        self._robot = robot
        self._slip = SlipEstimator(SlipSettings.from_robot(robot))
        self._grid = PeriodGrid(robot.odometry.rate_hz)
        self._index = 0
        self._delay_ns = to_nanoseconds(robot.control.transport_delay_s)
        self._underway: deque[VelocityCommand] = deque()
        self._command = Twist2(0.0, 0.0)
        self._belts = [0.0, 0.0]  # left, right (m/s)
        self._travel = [0.0, 0.0]
        self._counted = [0.0, 0.0]
        self._terrain = [0.0, 0.0]
        self._twist = Twist2(0.0, 0.0)
        self.truth = self.estimate = start or Pose2(0.0, 0.0, 0.0)

    @property
    def stamp_ns(self) -> int:
        """Stamp of the present instant."""
        return self._grid.stamp_ns(self._index)

    def submit(self, command: VelocityCommand) -> None:
        """A command; it reaches the motors a transport delay after its stamp."""
        self._underway.append(command)

    def advance(self) -> PlantSample:
        """Move on to the next instant of the odometry."""
        begin_ns = self.stamp_ns
        self._index += 1
        period_s = seconds_between(self.stamp_ns, begin_ns)
        self._vary_terrain(period_s)
        yaw_rates = []
        step_s = period_s / SUBSTEPS
        for substep in range(SUBSTEPS):
            now_ns = begin_ns + to_nanoseconds(substep * step_s)
            while self._underway and self._underway[0].stamp_ns + self._delay_ns <= now_ns:
                self._command = self._underway.popleft().twist
            self._move(step_s, now_ns / 1e9)
            yaw_rates.append(self._twist.yaw_rate_radps)
        return self._sense(period_s, float(np.mean(yaw_rates)))

    def _move(self, step_s: float, time_s: float) -> None:
        tracks, ground = self._robot.tracks, self.ground
        half_turn = 0.5 * tracks.gauge_m * self._command.yaw_rate_radps
        for side, wanted in enumerate((self._command.speed_mps - half_turn, self._command.speed_mps + half_turn)):
            wanted = min(max(wanted, -tracks.speed_limit_mps), tracks.speed_limit_mps)
            change = (wanted - self._belts[side]) / ground.belt_lag_s
            change = min(max(change, -tracks.acceleration_limit_mps2), tracks.acceleration_limit_mps2)
            self._belts[side] += step_s * change
            self._travel[side] += step_s * self._belts[side]
        self._twist = self._on_ground(time_s)
        turn = step_s * self._twist.yaw_rate_radps
        sideways = -ground.skid_m * self._twist.yaw_rate_radps
        middle = Pose2(self.truth.x_m, self.truth.y_m, self.truth.yaw_rad + 0.5 * turn)
        place = middle.compose(Pose2(step_s * self._twist.speed_mps, step_s * sideways, 0.0))
        self.truth = Pose2(place.x_m, place.y_m, wrap_angle(self.truth.yaw_rad + turn))

    def _on_ground(self, time_s: float) -> Twist2:
        ground = self.ground
        speed = 0.5 * (self._belts[0] + self._belts[1])
        yaw_rate = (self._belts[1] - self._belts[0]) / self._robot.tracks.gauge_m
        curvature = abs(yaw_rate) / max(abs(speed), 0.05)
        loss = ground.yaw_loss + ground.yaw_loss_on_spot * (1.0 - math.exp(-curvature / 2.5)) + self._terrain[0]
        yaw_rate /= max(1.0 + loss, 0.7)
        speed *= 1.0 - ground.speed_loss - 0.05 * ground.speed_loss * abs(yaw_rate) - self._terrain[1]
        begin_s, end_s = ground.kick_window_s
        moving = min(abs(speed) / 0.1, 1.0)
        if begin_s < time_s < end_s and ground.kick_radps != 0.0:
            share = math.sin(math.pi * (time_s - begin_s) / (end_s - begin_s)) * moving
            yaw_rate = (1.0 - 0.7 * share) * yaw_rate + ground.kick_radps * share
            speed *= 1.0 - 0.2 * share
        return Twist2(speed, yaw_rate)

    def _vary_terrain(self, period_s: float) -> None:
        decay = math.exp(-period_s / TERRAIN_CORRELATION_S)
        spread = self.ground.terrain * math.sqrt(1.0 - decay * decay)
        noise = self._generator.standard_normal(2)
        self._terrain[0] = decay * self._terrain[0] + spread * float(noise[0])
        self._terrain[1] = decay * self._terrain[1] + 0.3 * spread * float(noise[1])

    def _sense(self, period_s: float, mean_yaw_rate: float) -> PlantSample:
        robot, gauge = self._robot, self._robot.tracks.gauge_m
        tick, measured = robot.tracks.encoder_tick_m, []
        for side in range(2):
            counted = math.floor(self._travel[side] / tick) * tick
            measured.append((counted - self._counted[side]) / period_s)
            self._counted[side] = counted
        left, right = measured
        deviation = robot.imu.gyro_noise_radps / math.sqrt(robot.imu.rate_hz / robot.odometry.rate_hz)
        noise = deviation * float(self._generator.standard_normal())
        yaw_rate = mean_yaw_rate + self.ground.gyro_bias_radps + noise
        slip = self._slip.update(self.stamp_ns, left, right, yaw_rate, deviation**2, period_s)
        if not slip.known:  # at rest
            yaw_rate = 0.0
        speed = 0.5 * (left + right)
        turn = period_s * yaw_rate
        middle = Pose2(self.estimate.x_m, self.estimate.y_m, self.estimate.yaw_rad + 0.5 * turn)
        place = middle.compose(Pose2(period_s * speed, 0.0, 0.0))
        self.estimate = Pose2(place.x_m, place.y_m, wrap_angle(self.estimate.yaw_rad + turn))
        odometry = Odometry(
            self.stamp_ns,
            robot.frames.odom,
            robot.frames.base_footprint,
            self.estimate,
            Twist2(speed, yaw_rate),
            np.eye(3) * 1e-4,
            np.eye(2) * 1e-4,
        )
        true_slip = Twist2(
            self._twist.speed_mps - 0.5 * (self._belts[0] + self._belts[1]),
            self._twist.yaw_rate_radps - (self._belts[1] - self._belts[0]) / gauge,
        )
        return PlantSample(Estimate(odometry, slip), self.truth, true_slip)
