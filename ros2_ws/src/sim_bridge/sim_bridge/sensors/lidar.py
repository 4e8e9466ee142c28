"""Planar lidar of one revolution per scan, all beams at once or one after the other."""

from collections.abc import Callable

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from sim_bridge.sensors.mounting import PointMotion
from sim_bridge.sensors.rotations import cross_matrix, rotation_from_vector, vector_of_rotation
from tracked_description.robot import Lidar
from tracked_types import LaserScan, PeriodGrid

Array = NDArray[np.float64]
CastRays = Callable[[Array, Array], Array]
"""Origins and ends, (n, 3) each in the world, to the share of the way to the first hit, (n,); 1 is no hit."""

SCAN_MODES = ("rolling", "instant")


class LidarSensor:
    """Ranges of a revolution, with noise; +inf is no return, -inf an object too close to range (REP-117).

    In mode ``rolling`` the beams fire one after the other from where the sensor is at that moment, and the
    scan is stamped with its first beam, as a spinning lidar does: at 1.3 rad/s and 10 Hz its picture is
    skewed by 7 degrees. In mode ``instant`` they fire together at the stamp.

    `update` is called once per tick of ``tick_rate_hz``; a scan comes with the last tick of a revolution.
    """

    def __init__(
        self,
        model: Lidar,
        frame_id: str,
        mode: str,
        tick_rate_hz: int,
        random: Generator,
        start: PointMotion,
    ) -> None:
        if mode not in SCAN_MODES:
            raise ValueError(f"lidar mode must be one of {', '.join(SCAN_MODES)}; got {mode!r}")
        if tick_rate_hz % model.rate_hz:
            raise ValueError(f"lidar.rate_hz must divide {tick_rate_hz} Hz, got {model.rate_hz}")
        self._model = model
        self._frame_id = frame_id
        self._rolling = mode == "rolling"
        self._ticks_per_scan = tick_rate_hz // model.rate_hz
        self._grid = PeriodGrid(model.rate_hz)
        self._random = random
        self._previous = start
        angles = -np.pi + 2.0 * np.pi * np.arange(model.beams) / model.beams
        self._directions = np.column_stack([np.cos(angles), np.sin(angles), np.zeros(model.beams)])
        # -1 marks a beam that has not fired in this revolution: the robot has just been reset or started.
        self._distances = np.full(model.beams, -1.0)

    def restart(self, motion: PointMotion) -> None:
        """Go on from ``motion``: the robot was put elsewhere."""
        self._previous = motion

    def update(self, motion: PointMotion, tick: int, cast: CastRays) -> LaserScan | None:
        """Fire the beams of the tick ``tick`` (its end, counted from time zero); a scan if it is complete."""
        before, self._previous = self._previous, motion
        phase = (tick - 1) % self._ticks_per_scan
        complete = phase == self._ticks_per_scan - 1
        if self._rolling:
            self._fire_sector(before, motion, phase, cast)
        elif complete:
            self._fire(slice(None), motion.position_m[None], self._directions @ motion.rotation.T, cast)
        return self._scan(tick // self._ticks_per_scan) if complete else None

    def _fire_sector(self, before: PointMotion, now: PointMotion, phase: int, cast: CastRays) -> None:
        beams, ticks = self._model.beams, self._ticks_per_scan
        first, last = -(-phase * beams // ticks), -(-(phase + 1) * beams // ticks)
        if first == last:
            return
        share = (np.arange(first, last) * ticks / beams - phase)[:, None]
        origins = before.position_m + share * (now.position_m - before.position_m)
        turn = vector_of_rotation(before.rotation.T @ now.rotation)
        # Within one tick the sensor turns a few milliradians: first order about its middle is exact to 1e-5.
        middle = before.rotation @ rotation_from_vector(0.5 * turn)
        directions = self._directions[first:last]
        turned = directions + (share - 0.5) * (directions @ cross_matrix(turn).T)
        self._fire(slice(first, last), origins, turned @ middle.T, cast)

    def _fire(self, beams: slice, origins: Array, directions: Array, cast: CastRays) -> None:
        starts = np.broadcast_to(origins, directions.shape)
        share = cast(starts, starts + self._model.range_max_m * directions)
        self._distances[beams] = np.where(share < 1.0, share * self._model.range_max_m, np.inf)

    def _scan(self, revolution: int) -> LaserScan:
        model = self._model
        noise = model.noise_m * self._random.standard_normal(model.beams)
        ranges = self._distances + noise
        ranges[ranges > model.range_max_m] = np.inf
        ranges[ranges < model.range_min_m] = -np.inf
        ranges[self._distances < 0.0] = np.nan
        self._distances = np.full(model.beams, -1.0)
        scan_time = 1.0 / model.rate_hz
        return LaserScan(
            stamp_ns=self._grid.stamp_ns(revolution - 1 if self._rolling else revolution),
            frame_id=self._frame_id,
            angle_min_rad=-np.pi,
            angle_increment_rad=2.0 * np.pi / model.beams,
            time_increment_s=scan_time / model.beams if self._rolling else 0.0,
            scan_time_s=scan_time,
            range_min_m=model.range_min_m,
            range_max_m=model.range_max_m,
            ranges_m=ranges.astype(np.float32),
        )
