"""Drives through the rooms world by its truth, for the benchmarks of mapping and localisation: no stack steers here."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sim_bridge.floor_plan import floor_plan
from sim_bridge.sensor_suite import SensorBatch
from sim_bridge.simulator import Simulator
from sim_bridge.world import World, load_world
from tracked_description import Robot
from tracked_localization import Estimate, OdometryFilter, OdometryFilterSettings, SlipSettings
from tracked_localization.matching.line_world import LineWorld
from tracked_types import BodyState, PeriodGrid, Pose2, Twist2, VelocityCommand, wrap_angle
from tracked_types.checked_yaml import check_content

Point = tuple[float, float]
Array = NDArray[np.float64]
TOUR: tuple[Point, ...] = (
    *((2.2, 0.7), (4.0, 0.7), (5.3, 0.8), (6.6, 1.3), (6.0, 2.2), (6.0, 3.6)),
    *((6.0, 4.4), (4.8, 4.5), (3.2, 4.5), (2.0, 4.5), (2.0, 3.6), (2.0, 2.2), (1.0, 1.2)),
)
"""Round through hall and both rooms: over the ice, over the step, through all three doors."""
CRUISE_MPS, TURN_RADPS = 0.35, 1.0
NEAR_M, AIMED_RAD = 0.12, 0.25


def slippery_rooms() -> World:
    """The rooms with two sheets of ice, one of them under one track only, and a step of 40 mm."""
    content = load_world("rooms").model_dump(mode="json", exclude_unset=True)
    content["objects"] = [
        *content["objects"],
        {"name": "step", "shape": "step", "position_m": [5.1, 0.7], "length_m": 0.4, "width_m": 1.3, "height_m": 0.04},
    ]
    content["friction_zones"] = [
        {
            "name": "sheet",
            "centre_m": [3.2, 0.7],
            "size_m": [1.2, 1.2],
            "friction": {"longitudinal": 0.12, "lateral": 0.1},
        },
        {
            "name": "under_one_track",
            "centre_m": [3.4, 4.7],
            "size_m": [1.2, 0.35],
            "friction": {"longitudinal": 0.15, "lateral": 0.12},
        },
    ]
    return check_content(World, content, "slippery rooms")


@dataclass(frozen=True, slots=True)
class Moment:
    """One tick of the IMU: what the sensors gave, and the estimates that came of it."""

    batch: SensorBatch
    estimates: list[Estimate]


class Driver:
    """Turns towards the next point, on the spot if need be, and drives to it."""

    def __init__(self, points: Sequence[Point]) -> None:
        self._left = list(points)

    @property
    def arrived(self) -> bool:
        """Whether all points have been passed."""
        return not self._left

    def wish(self, pose: Pose2) -> Twist2:
        """What it would like to do now."""
        while self._left and math.dist(self._left[0], (pose.x_m, pose.y_m)) < NEAR_M:
            self._left.pop(0)
        if not self._left:
            return Twist2(0.0, 0.0)
        ahead = math.atan2(self._left[0][1] - pose.y_m, self._left[0][0] - pose.x_m)
        error = wrap_angle(ahead - pose.yaw_rad)
        rate = min(max(2.5 * error, -TURN_RADPS), TURN_RADPS)
        return Twist2(0.0 if abs(error) > AIMED_RAD else CRUISE_MPS, rate)


class RoomsDrive:
    """Simulator, odometry filter and driver; `moments` runs them."""

    def __init__(self, robot: Robot, world: World, seed: int, start: Pose2, points: Sequence[Point]) -> None:
        self.simulator = Simulator(robot, world, seed=seed, start=start)
        self.filter = OdometryFilter(OdometryFilterSettings.from_robot(robot, SlipSettings.from_robot(robot)))
        self.truth: list[BodyState] = []
        self._points = points
        self._driver = Driver(points)

    def true_poses(self, stamps_ns: Sequence[int]) -> Array:
        """The base in the world, (n, 3): x, y (m) and continuous heading (rad), between the states that are known."""
        known_ns = np.array([state.stamp_ns for state in self.truth])
        poses = np.array([state.pose.as_array() for state in self.truth])
        poses[:, 2] = np.unwrap(poses[:, 2])
        wanted_ns = np.array(stamps_ns)
        return np.column_stack([np.interp(wanted_ns, known_ns, poses[:, axis]) for axis in range(3)])

    def moments(self, seconds: float) -> Iterator[Moment]:
        """Every tick until the points are passed, at most for so long; without points the robot stands."""
        robot = self.simulator.robot
        limits, control = robot.limits, PeriodGrid(robot.control.rate_hz)
        period_s = 1.0 / control.rate_hz
        speed = rate = 0.0
        pose = self.simulator.start
        for _ in range(round(seconds * robot.imu.rate_hz)):
            batch = self.simulator.advance()
            for state in batch.truth:
                self.truth.append(state)
                pose = state.pose
            estimates = [estimate for sample in batch.imu for estimate in self.filter.add_imu(sample)]
            estimates += [estimate for sample in batch.tracks for estimate in self.filter.add_tracks(sample)]
            yield Moment(batch, estimates)
            if control.is_instant(batch.stamp_ns):
                wish = self._driver.wish(pose) if batch.stamp_ns > 1_000_000_000 else Twist2(0.0, 0.0)
                reach, turn_reach = limits.acceleration_mps2 * period_s, limits.yaw_acceleration_radps2 * period_s
                speed += min(max(wish.speed_mps - speed, -reach), reach)
                rate += min(max(wish.yaw_rate_radps - rate, -turn_reach), turn_reach)
                self.simulator.submit(VelocityCommand(batch.stamp_ns, Twist2(speed, rate)))
            if self._points and self._driver.arrived and abs(speed) + abs(rate) < 1e-6:
                return

    def close(self) -> None:
        """Free the world."""
        self.simulator.close()


def faces_of(world: World, robot: Robot) -> LineWorld:
    """Everything of the world that reaches up to the lidar, as it stands at the beginning."""
    height_m = robot.base_link_height_m + robot.lidar.xyz_m[2]
    shown = [each for each in floor_plan(world.model_copy(update={"walkers": ()})) if each.height_m > height_m]
    sides = [pair for each in shown for pair in zip(each.points, each.points[1:] + each.points[:1], strict=True)]
    return LineWorld(np.array(sides))


def start_of_seed(seed: int) -> Pose2:
    """A start near the usual one, heading anywhere."""
    x, y, yaw = np.random.default_rng([seed, 0x726F6F6D]).uniform(-1.0, 1.0, 3).tolist()
    return Pose2(1.0 + 0.2 * x, 1.2 + 0.2 * y, math.pi * yaw)
