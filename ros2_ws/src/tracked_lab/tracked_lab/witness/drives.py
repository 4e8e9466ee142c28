"""Drives among walls on belts, and on the kinematic plant whose ground changes under the robot."""

import math
from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np

from sim_bridge.simulator import Simulator
from tracked_description import Robot
from tracked_lab.kinematic_ground import Ground
from tracked_lab.kinematic_plant import KinematicBatch, KinematicPlant
from tracked_lab.line_lidar import LineLidar
from tracked_lab.simulation import make_simulator
from tracked_lab.witness.witness_track import Steer, WitnessTrack
from tracked_localization.matching.line_world import ROOM
from tracked_types import BodyState, LaserScan, Pose2, Twist2, VelocityCommand, wrap_angle

ROOMS_ROUTE = ((3.0, 0.8), (6.5, 0.7), (6.2, 2.2), (6.0, 4.4), (5.0, 4.5), (2.0, 4.5), (2.0, 2.3), (1.0, 1.2))
Change = tuple[float, float, float]
"""Of the ground: time (s), of the longitudinal loss, of the yaw loss."""
CIRCLE_START = Pose2(1.0, -0.3, 0.0)
_COMMAND_TICKS = 4


def along_route(route: tuple[tuple[float, float], ...], speed_mps: float = 0.4, rest_s: float = 1.0) -> Steer:
    """Drives from point to point by the truth, with spot turns where the way bends."""
    goal = 0

    def steer(time_s: float, truth: BodyState | None) -> tuple[float, float]:
        nonlocal goal
        if truth is None or time_s < rest_s:
            return 0.0, 0.0
        pose = truth.pose
        if math.hypot(route[goal][0] - pose.x_m, route[goal][1] - pose.y_m) < 0.15:
            goal = (goal + 1) % len(route)
        off = wrap_angle(math.atan2(route[goal][1] - pose.y_m, route[goal][0] - pose.x_m) - pose.yaw_rad)
        if abs(off) > 0.6:
            return 0.0, float(np.clip(2.0 * off, -1.2, 1.2))
        return speed_mps, float(np.clip(2.0 * off, -1.0, 1.0))

    return steer


def constant(speed_mps: float, yaw_rate_radps: float, rest_s: float = 1.0) -> Steer:
    """Rest, then always the same."""
    return lambda time_s, _truth: (0.0, 0.0) if time_s < rest_s else (speed_mps, yaw_rate_radps)


def on_belts(
    robot: Robot,
    seed: int,
    seconds: float,
    steer: Steer,
    *,
    world: str = "rooms",
    start: tuple[float, float, float] | None = None,
    event: Callable[[Simulator, float], None] | None = None,
    lidar: bool = True,
) -> WitnessTrack:
    """One drive in the physics world; ``event`` may change it before each tick."""
    parameters: dict[str, object] = {"world": world, "seed": seed}
    if start is not None:
        parameters |= {"start": "pose", "start_pose": start}
    simulator, track, truth = make_simulator(robot, parameters), WitnessTrack(robot), None
    try:
        for tick in range(round(seconds * robot.imu.rate_hz)):
            if event is not None:
                event(simulator, tick / robot.imu.rate_hz)
            batch = simulator.advance()
            truth = batch.truth[-1] if batch.truth else truth
            if tick % _COMMAND_TICKS == 0:
                simulator.submit(VelocityCommand(batch.stamp_ns, Twist2(*steer(batch.stamp_ns * 1e-9, truth))))
            track.add(batch.imu, batch.tracks, batch.scans if lidar else (), batch.truth, batch.truth_slip)
    finally:
        simulator.close()
    return track


def changing_ground(
    robot: Robot, seed: int, seconds: float
) -> Iterator[tuple[KinematicBatch, LaserScan | None, Change | None]]:
    """Circles through a room of straight walls; every three seconds the ground is another.

    Yields each tick's batch, the scan that ends there, and a change.
    """
    draws = np.random.default_rng(seed)
    ground = Ground.of_seed(seed)
    plant = KinematicPlant(robot, seed, ground, CIRCLE_START)
    lidar = LineLidar(robot, ROOM, seed, CIRCLE_START)
    next_change_s = 4.0
    for tick in range(round(seconds * robot.imu.rate_hz)):
        batch, change = plant.advance(), None
        now_s = batch.stamp_ns * 1e-9
        x, y, yaw = plant.truth_pose
        if tick % _COMMAND_TICKS == 0:
            inwards = wrap_angle(math.atan2(0.5 - y, 0.5 - x) - yaw)
            far = math.hypot(0.5 - x, 0.5 - y) > 1.5
            rate = 0.75 + (0.4 if far and inwards > 0.0 else -0.15 if far else 0.0)
            plant.submit(VelocityCommand(batch.stamp_ns, Twist2(0.4, rate) if now_s > 1.0 else Twist2(0.0, 0.0)))
        if now_s > next_change_s:
            before = plant.ground
            losses = float(draws.uniform(0.0, 0.4)), float(draws.uniform(0.0, 0.6))
            plant.set_ground(replace(ground, speed_loss=losses[0], yaw_loss=losses[1]))
            change = (now_s, losses[0] - before.speed_loss, losses[1] - before.yaw_loss)
            next_change_s += 3.0
        yield batch, lidar.update(Pose2(x, y, yaw)), change


def on_changing_ground(robot: Robot, seed: int, seconds: float) -> tuple[WitnessTrack, list[Change]]:
    """What the witness says on `changing_ground`, and the changes."""
    track, changes = WitnessTrack(robot), []
    for batch, scan, change in changing_ground(robot, seed, seconds):
        track.add(batch.imu, batch.tracks, () if scan is None else (scan,), batch.truth, batch.truth_slip)
        changes += [] if change is None else [change]
    return track, changes
