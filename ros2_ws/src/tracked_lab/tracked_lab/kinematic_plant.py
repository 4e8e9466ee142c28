"""A slipping tracked robot in the plane, fast enough for thousands of runs.

Its ground is deliberately not the controllers' model: belts lag and are limited in acceleration, turning loses yaw
like a track pair with widened instantaneous centres of rotation, with a share that depends on the turn and on slowly
varying terrain; there is longitudinal slip, sideways skid and, where asked for, an obstacle that takes the yaw rate
over. Its sensors are those of the simulated robot: an IMU and belt encoders, with the same noise.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from robust_core.plants.x_structure import STANDARD_GRAVITY_MPS2
from sim_bridge.command_intake import CommandIntake, IntakeSettings
from sim_bridge.sensors.encoders import BeltEncoders
from sim_bridge.sensors.rotations import rotation_from_roll_pitch_yaw
from sim_bridge.track_speeds import track_targets
from tracked_description import Robot
from tracked_lab.kinematic_ground import Ground
from tracked_lab.kinematic_motion import (
    FORWARD,
    LEFT_TRAVEL,
    RIGHT_TRAVEL,
    SIDEWAYS,
    SPEED,
    SUBSTEPS,
    TURN,
    YAW_RATE,
    move,
    new_state,
    sense,
)
from tracked_types import (
    BodyState,
    ImuSample,
    PeriodGrid,
    Pose2,
    Slip,
    TrackSample,
    Twist2,
    VelocityCommand,
    wrap_angle,
)

Array = NDArray[np.float64]
NOISE_TICKS = 1024  # ticks whose noise is drawn in one go


@dataclass(frozen=True, slots=True)
class KinematicBatch:
    """What the sensors, and an ideal outside observer, deliver at one tick."""

    stamp_ns: int
    imu: tuple[ImuSample, ...]
    tracks: tuple[TrackSample, ...]
    truth: tuple[BodyState, ...]
    truth_slip: tuple[Slip, ...]


class KinematicPlant:
    """Advances tick by tick of its IMU; equal seeds and commands give bit-identical batches.

    Parameters
    ----------
    robot: gauge, sensors, limits and delays are its own.
    seed: of the ground and of all noise.
    ground: instead of the one that the seed would draw, without obstacle.
    start: true pose at time zero.
    """

    def __init__(self, robot: Robot, seed: int, ground: Ground | None = None, start: Pose2 | None = None) -> None:
        self.ground = ground or Ground.of_seed(seed)
        self.start = start or Pose2(0.0, 0.0, 0.0)
        self._robot = robot
        self._ground = self.ground.as_array()
        self._state = new_state(self.start.x_m, self.start.y_m, self.start.yaw_rad)
        self._intake = CommandIntake(IntakeSettings.from_robot(robot))
        self._targets = np.zeros((SUBSTEPS, 2))
        self._twists: list[Twist2 | None] = [None] * SUBSTEPS
        self._grid = PeriodGrid(robot.imu.rate_hz)
        self._steps = PeriodGrid(robot.imu.rate_hz * SUBSTEPS)
        self._period_s = 1.0 / robot.imu.rate_hz
        self._tick = 0
        self._ticks_per_base = robot.imu.rate_hz // robot.odometry.rate_hz
        self._encoders = BeltEncoders(robot.tracks.encoder_tick_m, robot.odometry.rate_hz)
        self._noise = _Noise(robot, np.random.default_rng(seed))
        self._mount = rotation_from_roll_pitch_yaw(*robot.imu.rpy_rad)
        self._gyro_covariance = np.eye(3) * robot.imu.gyro_noise_radps**2
        self._acceleration_covariance = np.eye(3) * robot.imu.acceleration_noise_mps2**2
        self._belts_m = (0.0, 0.0)

    @property
    def stamp_ns(self) -> int:
        """Stamp of the present tick."""
        return self._grid.stamp_ns(self._tick)

    @property
    def truth_pose(self) -> tuple[float, float, float]:
        """True x (m), y (m) and heading (rad, not wrapped) now."""
        x, y, yaw = self._state[:3].tolist()
        return x, y, yaw

    def set_ground(self, ground: Ground) -> None:
        """From now on the robot is on other ground."""
        self.ground, self._ground = ground, ground.as_array()

    def submit(self, command: VelocityCommand) -> None:
        """Take a command; it reaches the motors a transport delay after its stamp, refused as by the simulator."""
        self._intake.submit(command, self.stamp_ns)

    def close(self) -> None:
        """Nothing is held."""

    def advance(self) -> KinematicBatch:
        """Move on to the next tick."""
        state = self._state
        speed_before, sideways_before = float(state[SPEED]), float(state[SIDEWAYS])
        yaw_noise, speed_noise, rates, forces = self._noise.next()
        mean_yaw_rate = self._move(yaw_noise, speed_noise)
        mount, gravity = self._mount, STANDARD_GRAVITY_MPS2
        sense(state, speed_before, sideways_before, mean_yaw_rate, self._period_s, mount, gravity, rates, forces)
        self._tick += 1
        stamp_ns = self._grid.stamp_ns(self._tick)
        imu = ImuSample(
            stamp_ns, self._robot.frames.imu, rates, forces, self._gyro_covariance, self._acceleration_covariance
        )
        if self._tick % self._ticks_per_base:
            return KinematicBatch(stamp_ns, (imu,), (), (), ())
        left, right = float(state[LEFT_TRAVEL]), float(state[RIGHT_TRAVEL])
        tracks = self._encoders.update(left, right, stamp_ns)
        slip = self._slip(left, right, stamp_ns)
        return KinematicBatch(stamp_ns, (imu,), (tracks,), (self._truth(stamp_ns),), (slip,))

    def _move(self, yaw_noise: float, speed_noise: float) -> float:
        tracks, step_s = self._robot.tracks, self._period_s / SUBSTEPS
        begin = self._tick * SUBSTEPS
        for substep in range(SUBSTEPS):
            twist = self._intake.update(self._steps.stamp_ns(begin + substep), step_s)
            if twist is not self._twists[substep]:  # most often it is that of the tick before
                self._twists[substep] = twist
                self._targets[substep] = track_targets(twist, tracks)
        mean_yaw_rate: float = move(
            self._state,
            self._ground,
            self._targets,
            tracks.acceleration_limit_mps2,
            tracks.gauge_m,
            self._tick * self._period_s,
            step_s,
            yaw_noise,
            speed_noise,
        )
        return mean_yaw_rate

    def _truth(self, stamp_ns: int) -> BodyState:
        x, y, yaw = self.truth_pose
        return BodyState(
            stamp_ns,
            np.array([x, y, 0.0]),
            np.array([0.0, 0.0, wrap_angle(yaw)]),
            np.array([self._state[SPEED], self._state[SIDEWAYS], 0.0]),
            np.array([0.0, 0.0, self._state[YAW_RATE]]),
            0.0,
        )

    def _slip(self, left_m: float, right_m: float, stamp_ns: int) -> Slip:
        """Mean ground motion less mean belt motion over the encoders' period, as the simulator's observer has it."""
        state, rate_hz = self._state, self._robot.odometry.rate_hz
        left, right = left_m - self._belts_m[0], right_m - self._belts_m[1]
        self._belts_m = (left_m, right_m)
        speed = (float(state[FORWARD]) - 0.5 * (left + right)) * rate_hz
        yaw_rate = (float(state[TURN]) - (right - left) / self._robot.tracks.gauge_m) * rate_hz
        state[FORWARD] = state[TURN] = 0.0
        return Slip(stamp_ns, speed, yaw_rate, 0.0, 0.0, True)


class _Noise:
    """Noise of terrain and IMU, drawn for many ticks at a time; the IMU's is white, plus a bias that walks."""

    def __init__(self, robot: Robot, generator: Generator) -> None:
        self._imu = robot.imu
        self._generator = generator
        # Its sign differs from run to run; the simulator's gyro always has the same.
        self._bias = math.copysign(robot.imu.gyro_bias_radps, generator.random() - 0.5) * np.ones(3)
        self._index = NOISE_TICKS

    def next(self) -> tuple[float, float, Array, Array]:
        """Standard normal noise of both terrains, and the IMU's own part of rates and forces, (3,) each."""
        if self._index == NOISE_TICKS:
            self._draw()
        index = self._index
        self._index += 1
        return *self._terrain[index], self._rates[index], self._forces[index]

    def _draw(self) -> None:
        imu, normal = self._imu, self._generator.standard_normal((NOISE_TICKS, 11))
        self._terrain: list[list[float]] = normal[:, :2].tolist()
        walk = imu.gyro_bias_walk_radps_sqrt_s / math.sqrt(imu.rate_hz)
        bias = self._bias + walk * np.cumsum(normal[:, 2:5], axis=0)
        self._bias = bias[-1]
        self._rates = bias + imu.gyro_noise_radps * normal[:, 5:8]
        self._forces = imu.acceleration_bias_mps2 + imu.acceleration_noise_mps2 * normal[:, 8:11]
        self._index = 0
