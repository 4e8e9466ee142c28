"""A spinning lidar among straight walls, for plants that know no world: rays are cast, no physics is stepped."""

import numpy as np

from tracked_description import Robot
from tracked_localization.matching.line_world import LineWorld
from tracked_types import LaserScan, PeriodGrid, Pose2, wrap_angle


class LineLidar:
    """Beams fire one after the other from where the robot is at that moment, as the simulator's lidar does.

    `update` is called once per tick of the IMU with the true pose of the base; a scan comes with the last tick of a
    revolution, stamped with its first beam.
    """

    def __init__(self, robot: Robot, world: LineWorld, seed: int, start: Pose2) -> None:
        lidar = robot.lidar
        self._robot, self._world = robot, world
        self._mounting = Pose2(lidar.xyz_m[0], lidar.xyz_m[1], lidar.rpy_rad[2])
        self._ticks = robot.imu.rate_hz // lidar.rate_hz
        self._grid = PeriodGrid(lidar.rate_hz)
        self._angles = -np.pi + 2.0 * np.pi * np.arange(lidar.beams) / lidar.beams
        self._generator = np.random.default_rng(seed)
        self._ranges = np.full(lidar.beams, np.inf)
        self._before, self._tick = start, 0

    def update(self, base: Pose2) -> LaserScan | None:
        """Fire the beams of one tick, at whose end the base is at ``base``."""
        lidar = self._robot.lidar
        phase = self._tick % self._ticks
        self._tick += 1
        first, last = (-(-edge * lidar.beams // self._ticks) for edge in (phase, phase + 1))
        share = np.arange(first, last) * self._ticks / lidar.beams - phase
        begin = self._before
        turn = wrap_angle(base.yaw_rad - begin.yaw_rad)
        yaw = begin.yaw_rad + share * turn
        mounted = np.array([self._mounting.x_m, self._mounting.y_m])
        origins = np.column_stack(
            [
                begin.x_m + share * (base.x_m - begin.x_m) + np.cos(yaw) * mounted[0] - np.sin(yaw) * mounted[1],
                begin.y_m + share * (base.y_m - begin.y_m) + np.sin(yaw) * mounted[0] + np.cos(yaw) * mounted[1],
            ]
        )
        headings = self._angles[first:last] + yaw + self._mounting.yaw_rad
        self._ranges[first:last] = self._world.cast(origins, headings)
        self._before = base
        if phase < self._ticks - 1:
            return None
        ranges = self._ranges + lidar.noise_m * self._generator.standard_normal(lidar.beams)
        ranges[ranges > lidar.range_max_m] = np.inf
        ranges[ranges < lidar.range_min_m] = -np.inf
        return LaserScan(
            self._grid.stamp_ns(self._tick // self._ticks - 1),
            self._robot.frames.lidar,
            -np.pi,
            2.0 * np.pi / lidar.beams,
            1.0 / (lidar.rate_hz * lidar.beams),
            1.0 / lidar.rate_hz,
            lidar.range_min_m,
            lidar.range_max_m,
            ranges.astype(np.float32),
        )
