"""All sensors of the robot on one clock: what they deliver at each tick, faults included."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.random import SeedSequence
from numpy.typing import NDArray

from sim_bridge.corruption import ImuCorruption, ScanCorruption, TracksCorruption
from sim_bridge.fault_injector import FaultySensor
from sim_bridge.faults import Fault, Sensor
from sim_bridge.sensors.encoders import BeltEncoders
from sim_bridge.sensors.imu import ImuSensor
from sim_bridge.sensors.lidar import CastRays, LidarSensor
from sim_bridge.sensors.mounting import Mounting, PointMotion
from sim_bridge.sensors.truth import BaseMotion, TruthObserver
from tracked_description import Robot
from tracked_types import BodyState, ImuSample, LaserScan, PeriodGrid, Slip, TrackSample


@dataclass(frozen=True, slots=True)
class VehicleMotion:
    """What the sensors need to know of the vehicle at one instant.

    chassis: motion of the centre of mass. left_travel_m, right_travel_m: of the belts.
    suspension_travel_m: (2 wheels,) left side first, front to rear as the vehicle counts.
    """

    chassis: PointMotion
    left_travel_m: float
    right_travel_m: float
    suspension_travel_m: NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class SensorBatch:
    """What listeners get at one tick; a fault may withhold samples or deliver earlier ones late.

    suspension_travel_m: (2 wheels,) at the tick.
    """

    stamp_ns: int
    imu: tuple[ImuSample, ...]
    tracks: tuple[TrackSample, ...]
    scans: tuple[LaserScan, ...]
    truth: tuple[BodyState, ...]
    truth_slip: tuple[Slip, ...]
    suspension_travel_m: NDArray[np.float64]


class SensorSuite:
    """The robot's sensors and the ground truth, ticked at the IMU's rate.

    Every sensor and every fault draws from a generator of its own, spawned from one seed.

    Raises
    ------
    ValueError: if the rates of robot.yaml do not divide the IMU's.
    """

    def __init__(self, robot: Robot, lidar_mode: str, seed: int, start: VehicleMotion) -> None:
        tick_rate_hz, base_rate_hz = robot.imu.rate_hz, robot.odometry.rate_hz
        if tick_rate_hz % base_rate_hz:
            raise ValueError(f"odometry.rate_hz must divide imu.rate_hz ({tick_rate_hz}), got {base_rate_hz}")
        generators = [np.random.default_rng(child) for child in SeedSequence(seed).spawn(5)]
        imu, lidar, imu_faults, scan_faults, tracks_faults = generators
        self._ticks_per_base_sample = tick_rate_hz // base_rate_hz
        self._grid = PeriodGrid(tick_rate_hz)
        self._imu_mounting = Mounting.of_sensor(robot.imu, robot)
        self._lidar_mounting = Mounting.of_sensor(robot.lidar, robot)
        self._base_mounting = Mounting.of_base_footprint(robot)
        self._imu = ImuSensor(robot.imu, robot.frames.imu, imu, self._imu_mounting.motion(start.chassis))
        self._lidar = LidarSensor(
            robot.lidar,
            robot.frames.lidar,
            lidar_mode,
            tick_rate_hz,
            lidar,
            self._lidar_mounting.motion(start.chassis),
        )
        self._encoders = BeltEncoders(robot.tracks.encoder_tick_m, base_rate_hz)
        self._truth = TruthObserver(robot.tracks.gauge_m, base_rate_hz, self._base_motion(start))
        self._faulty_imu = FaultySensor(ImuCorruption(), imu_faults)
        self._faulty_scan = FaultySensor(ScanCorruption(), scan_faults)
        self._faulty_tracks = FaultySensor(TracksCorruption(base_rate_hz), tracks_faults)
        self._faulty: dict[Sensor, FaultySensor[Any]] = {
            "imu": self._faulty_imu,
            "scan": self._faulty_scan,
            "tracks": self._faulty_tracks,
        }

    @property
    def gyro_bias_radps(self) -> NDArray[np.float64]:
        """The gyro's present bias, (3,) in its frame."""
        return self._imu.gyro_bias_radps

    def restart(self, motion: VehicleMotion) -> None:
        """Go on from ``motion``: the robot was put elsewhere, which no sensor takes for movement."""
        self._imu.restart(self._imu_mounting.motion(motion.chassis))
        self._lidar.restart(self._lidar_mounting.motion(motion.chassis))
        self._truth.restart(self._base_motion(motion))

    def inject(self, fault: Fault) -> None:
        """Add a fault to the sensor it names."""
        self._faulty[fault.sensor].inject(fault)

    def end_faults(self, sensor: Sensor) -> None:
        """End every fault of one sensor."""
        self._faulty[sensor].end_faults()

    def active_faults(self, now_ns: int) -> tuple[Fault, ...]:
        """Faults that act now."""
        return tuple(fault for sensor in self._faulty.values() for fault in sensor.active(now_ns))

    def update(self, motion: VehicleMotion, tick: int, cast: CastRays) -> SensorBatch:
        """What is delivered at the end of tick ``tick`` (counted from time zero)."""
        now_ns = self._grid.stamp_ns(tick)
        imu = self._imu.update(self._imu_mounting.motion(motion.chassis), now_ns)
        scan = self._lidar.update(self._lidar_mounting.motion(motion.chassis), tick, cast)
        tracks: TrackSample | None = None
        truth: tuple[BodyState, ...] = ()
        truth_slip: tuple[Slip, ...] = ()
        if tick % self._ticks_per_base_sample == 0:
            tracks = self._encoders.update(motion.left_travel_m, motion.right_travel_m, now_ns)
            state, slip = self._truth.update(self._base_motion(motion), now_ns)
            truth, truth_slip = (state,), (slip,)
        return SensorBatch(
            stamp_ns=now_ns,
            imu=tuple(self._faulty_imu.update(imu, now_ns)),
            tracks=tuple(self._faulty_tracks.update(tracks, now_ns)),
            scans=tuple(self._faulty_scan.update(scan, now_ns)),
            truth=truth,
            truth_slip=truth_slip,
            suspension_travel_m=motion.suspension_travel_m,
        )

    def _base_motion(self, motion: VehicleMotion) -> BaseMotion:
        base = self._base_mounting.motion(motion.chassis)
        return BaseMotion(base, motion.left_travel_m, motion.right_travel_m)
