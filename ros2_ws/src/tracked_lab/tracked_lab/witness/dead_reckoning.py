"""Dead reckoning without a lidar: rectangles with rests and spot turns, reckoned in several ways."""

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tracked_description import Robot
from tracked_lab.belt_ground import BeltGround
from tracked_lab.conditions import Conditions
from tracked_lab.kinematic_plant import KinematicPlant
from tracked_lab.plant import Plant
from tracked_lab.simulation import make_simulator
from tracked_localization import OdometryFilter, OdometryFilterSettings
from tracked_types import ImuSample, Pose2, TrackSample, Twist2, VelocityCommand, wrap_angle

Array = NDArray[np.float64]
_CORNERS = ((3.0, 0.0), (3.0, 3.0), (0.0, 3.0), (0.0, 0.0))
_LENGTH_M = 40.0
_FIRST_REST_S = 5.0
_REST_S = 2.0
_COMMAND_TICKS = 4
SLIDE_S = 0.2
"""Outward slide per yaw rate of this robot, tuned on seeds from 1000 on."""


@dataclass(frozen=True, slots=True)
class Drift:
    """Root mean squares over all instants of all drives; end_m: of the ends alone."""

    heading_rad: float
    position_m: float
    end_m: float


@dataclass(frozen=True, slots=True)
class ReckonedDrive:
    """Samples of one drive and the truth at each sample of the belts, (n, 3), in the frame of the start."""

    imu: list[ImuSample]
    tracks: list[TrackSample]
    truth: Array


def drifts(robot: Robot, plant: str, seeds: Iterable[int]) -> dict[str, Drift]:
    """Drift of every way of reckoning over the drives of these seeds; one multiplier is the best for all of them."""
    drives = [recorded(robot, make(robot, plant, seed), seed) for seed in seeds]
    gauge_m = robot.tracks.gauge_m
    settings = OdometryFilterSettings.from_robot(robot)
    sliding = OdometryFilterSettings.from_robot(robot, slide_s=SLIDE_S)
    ways: dict[str, list[Array]] = {
        "encoders, best multiplier": _best_encoders(drives, gauge_m),
        "gyro, bias of the first rest": [_gyro_and_belts(drive, _first_bias(drive)) for drive in drives],
        "gyro and belt speed": [_filtered(drive, settings) for drive in drives],
        "filter with slip states": [_filtered(drive, sliding) for drive in drives],
    }
    return {name: _drift(found, drives) for name, found in ways.items()}


def make(robot: Robot, plant: str, seed: int) -> Plant:
    """The belts on varied ground, or the kinematic plant."""
    if plant == "kinematic":
        return KinematicPlant(robot, seed)
    ground = BeltGround.under(Conditions(varied_ground=True), seed)
    simulator = make_simulator(robot, {"world": "flat", "seed": seed}, ground.moved)
    ground.apply(simulator.vehicle, simulator.world, robot)
    return simulator


def recorded(robot: Robot, plant: Plant, seed: int) -> ReckonedDrive:
    """Drive 40 m by the truth: straights that wind a little, a rest and a turn on the spot at each corner."""
    draws = np.random.default_rng(seed + 99)
    corners = _CORNERS if seed % 2 else tuple((y, x) for x, y in _CORNERS)
    imu: list[ImuSample] = []
    tracks: list[TrackSample] = []
    truth: list[Array] = []
    back, pose = plant.start.inverse(), Pose2(0.0, 0.0, 0.0)
    length_m, rest_until_s, corner, spins, speed, tick = 0.0, _FIRST_REST_S, 0, False, 0.4, 0
    while length_m < _LENGTH_M:
        batch = plant.advance()
        now_s = batch.stamp_ns * 1e-9
        imu += batch.imu
        for state, sample in zip(batch.truth, batch.tracks, strict=True):
            before, pose = pose, back.compose(state.pose)
            length_m += math.hypot(pose.x_m - before.x_m, pose.y_m - before.y_m)
            tracks.append(sample)
            truth.append(pose.as_array())
        if tick % _COMMAND_TICKS == 0:
            x, y = corners[corner][0] - pose.x_m, corners[corner][1] - pose.y_m
            off = wrap_angle(math.atan2(y, x) - pose.yaw_rad)
            command = Twist2(0.0, 0.0)
            if now_s >= rest_until_s and math.hypot(x, y) < 0.12:
                corner, spins, rest_until_s = (corner + 1) % len(corners), True, now_s + _REST_S
                speed = float(draws.uniform(0.3, 0.45))
            elif now_s >= rest_until_s:
                spins = spins and abs(off) > 0.05
                winding = 1.5 * off + 0.35 * math.sin(now_s)
                command = (
                    Twist2(0.0, float(np.clip(2.5 * off, -1.2, 1.2)))
                    if spins
                    else Twist2(speed, float(np.clip(winding, -1.0, 1.0)))
                )
            plant.submit(VelocityCommand(batch.stamp_ns, command))
        tick += 1
    plant.close()
    return ReckonedDrive(imu, tracks, np.array(truth))


def _belts(drive: ReckonedDrive, gauge_m: float) -> tuple[Array, Array]:
    """Travel and turn (n,) of the belts since the sample before, zero for the first."""
    left = np.array([sample.left_travel_m for sample in drive.tracks])
    right = np.array([sample.right_travel_m for sample in drive.tracks])
    return np.diff(0.5 * (left + right), prepend=0.5 * (left[0] + right[0])), np.diff(
        (right - left) / gauge_m, prepend=(right[0] - left[0]) / gauge_m
    )


def _reckoned(travel: Array, turns: Array) -> Array:
    """Poses (n, 3) from travel and turn of each step, by the midpoint rule."""
    yaw = np.cumsum(turns)
    middle = yaw - 0.5 * turns
    return np.column_stack([np.cumsum(travel * np.cos(middle)), np.cumsum(travel * np.sin(middle)), yaw])


def _best_encoders(drives: list[ReckonedDrive], gauge_m: float) -> list[Array]:
    belts = [_belts(drive, gauge_m) for drive in drives]

    def reckon(multiplier: float) -> list[Array]:
        return [_reckoned(travel, multiplier * turns) for travel, turns in belts]

    multipliers = np.arange(0.5, 1.1, 0.005)
    best = min(multipliers, key=lambda multiplier: _drift(reckon(float(multiplier)), drives).heading_rad)
    return reckon(float(best))


def _first_bias(drive: ReckonedDrive) -> float:
    early = [s.angular_velocity_radps[2] for s in drive.imu if s.stamp_ns < (_FIRST_REST_S - 0.1) * 1e9]
    return float(np.mean(early))


def _gyro_and_belts(drive: ReckonedDrive, bias_radps: float) -> Array:
    """Belts' travel with the integrated gyro, one constant bias taken from it."""
    stamps = np.array([sample.stamp_ns for sample in drive.imu]) * 1e-9
    rates = np.array([sample.angular_velocity_radps[2] for sample in drive.imu]) - bias_radps
    angle = np.cumsum(rates * np.diff(stamps, prepend=0.0))
    yaw = np.interp([sample.stamp_ns * 1e-9 for sample in drive.tracks], stamps, angle)
    return _reckoned(_belts(drive, 1.0)[0], np.diff(yaw, prepend=yaw[0]))


def _filtered(drive: ReckonedDrive, settings: OdometryFilterSettings) -> Array:
    """Poses (n, 3) of the odometry filter at the samples of the belts."""
    odometry_filter, estimates, heard = OdometryFilter(settings), [], 0
    for sample in drive.tracks:
        while heard < len(drive.imu) and drive.imu[heard].stamp_ns <= sample.stamp_ns:
            estimates += odometry_filter.add_imu(drive.imu[heard])
            heard += 1
        estimates += odometry_filter.add_tracks(sample)
    stamps = np.array([estimate.odometry.stamp_ns for estimate in estimates]) * 1e-9
    poses = np.array([estimate.odometry.pose.as_array() for estimate in estimates])
    poses[:, 2] = np.unwrap(poses[:, 2])
    wanted = [sample.stamp_ns * 1e-9 for sample in drive.tracks]
    return np.column_stack([np.interp(wanted, stamps, poses[:, axis]) for axis in range(3)])


def _drift(found: list[Array], drives: list[ReckonedDrive]) -> Drift:
    errors = [poses - drive.truth for poses, drive in zip(found, drives, strict=True)]
    heading = np.concatenate([np.angle(np.exp(1j * error[:, 2])) for error in errors])
    square = np.concatenate([error[:, 0] ** 2 + error[:, 1] ** 2 for error in errors])
    ends = np.array([error[-1, 0] ** 2 + error[-1, 1] ** 2 for error in errors])
    return Drift(float(np.sqrt(np.mean(heading**2))), float(np.sqrt(square.mean())), float(np.sqrt(ends.mean())))
