"""A base on the bench: it answers cmd_vel perfectly, has no physics, and goes on when its odometry has come back.

Its lidar sees nothing far and wide.
"""

from typing import Any

import numpy as np
from geometry_msgs.msg import TwistStamped
from nav_msgs.msg import Odometry
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import Imu, JointState, LaserScan

from node_kit.conversions import clock_to_message, imu_to_message, scan_to_message, tracks_to_message
from tests.support.probe import Probe
from tracked_description import Robot
from tracked_safety.bench_inputs import BEAMS, scan
from tracked_types import ImuSample, PeriodGrid, TrackSample

GRAVITY_MPS2 = 9.80665
LAG_TICKS = 4  # of the IMU: how far odometry may lag behind the sensors
ODOMETRY_LIMIT_S = 30.0


class BenchBase:
    """Publishes clock, imu/data, joint_states and scan of a robot that moves as it is told."""

    def __init__(self, probe: Probe, robot: Robot) -> None:
        self._probe = probe
        self._robot = robot
        self._grid = PeriodGrid(robot.imu.rate_hz)
        self._covariance = np.eye(3) * 1e-4
        self._speed = self._yaw_rate = 0.0
        self._travel = [0.0, 0.0]
        self.tick = 0
        self.odometry = probe.collect(Odometry, "odom", 100)
        self.commands = probe.collect(TwistStamped, "cmd_vel", 100)
        create = probe.node.create_publisher
        self._clock, self._imu = create(Clock, "clock", 10), create(Imu, "imu/data", 10)
        self._joints, self._scan = create(JointState, "joint_states", 10), create(LaserScan, "scan", 10)

    @property
    def stamp_ns(self) -> int:
        """Its time."""
        return self._grid.stamp_ns(self.tick)

    def jump(self, seconds: float) -> None:
        """Put its clock on or back."""
        self.tick += round(seconds * self._grid.rate_hz)
        self.forget()

    def forget(self) -> None:
        """Drop what it has heard."""
        self.odometry.clear()
        self.commands.clear()

    def run(self, seconds: float) -> None:
        """Live for so long, never further ahead of the odometry than a few ticks.

        Raises:
            AssertionError: odometry does not follow.
        """
        first = self.tick
        for _ in range(round(seconds * self._grid.rate_hz)):
            self.tick += 1
            self._sense()
            if self.tick - first > LAG_TICKS:
                self._probe.wait_until(self._is_answered, timeout_s=ODOMETRY_LIMIT_S, what=f"odometry at {self.tick}")

    def _is_answered(self) -> bool:
        """Whether the odometry has followed; one of another time does not count."""
        due_ns = self._grid.stamp_ns(self.tick - LAG_TICKS)
        return bool(self.odometry) and due_ns <= _stamp_ns(self.odometry[-1]) <= self.stamp_ns

    def _sense(self) -> None:
        period_s = 1.0 / self._grid.rate_hz
        before = self._speed
        if self.commands:
            twist = self.commands[-1].twist
            self._speed, self._yaw_rate = twist.linear.x, twist.angular.z
        speeds = [self._speed + side * self._yaw_rate * self._robot.tracks.gauge_m / 2.0 for side in (-1.0, 1.0)]
        self._travel = [travel + speed * period_s for travel, speed in zip(self._travel, speeds, strict=True)]
        force = np.array([(self._speed - before) / period_s, self._speed * self._yaw_rate, GRAVITY_MPS2])
        rate = np.array([0.0, 0.0, self._yaw_rate])
        imu = ImuSample(self.stamp_ns, self._robot.frames.imu, rate, force, self._covariance, self._covariance)
        self._imu.publish(imu_to_message(imu))
        ticks_per_scan = self._robot.imu.rate_hz // self._robot.lidar.rate_hz
        if self.tick % ticks_per_scan == 0 and self.tick >= ticks_per_scan:
            began_ns = self._grid.stamp_ns(self.tick - ticks_per_scan)
            self._scan.publish(scan_to_message(scan(began_ns, np.full(BEAMS, np.inf))))
        if self.tick % 2 == 0:
            tracks = TrackSample(self.stamp_ns, *self._travel, *speeds)
            self._clock.publish(clock_to_message(self.stamp_ns))
            self._joints.publish(tracks_to_message(tracks, wheel_radius_m=self._robot.tracks.wheel_radius_m))


def _stamp_ns(message: Any) -> int:
    return int(message.header.stamp.sec * 10**9 + message.header.stamp.nanosec)
