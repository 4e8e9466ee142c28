"""Walls as straight lines, and exact scans of them: for tests, benchmarks and runs without physics."""

from dataclasses import dataclass

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from tracked_types import LaserScan, Pose2

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class LineWorld:
    """Walls (n, 2, 2): begin and end of each, x and y (m)."""

    walls: Array

    def scan(
        self,
        lidar: Pose2,
        generator: Generator | None = None,
        *,
        stamp_ns: int = 0,
        beams: int = 360,
        noise_m: float = 0.002,
        range_max_m: float = 18.0,
    ) -> LaserScan:
        """What a lidar at ``lidar`` sees, all beams at once; without ``generator`` there is no noise."""
        angles = -np.pi + np.arange(beams) * 2.0 * np.pi / beams
        headings = angles + lidar.yaw_rad
        ranges = self.ranges(lidar, headings)
        if generator is not None:
            ranges = ranges + noise_m * generator.standard_normal(beams)
        seen = np.where(ranges > range_max_m, np.inf, ranges).astype(np.float32)
        return LaserScan(stamp_ns, "laser", -np.pi, 2.0 * np.pi / beams, 0.0, 0.1, 0.15, range_max_m, seen)

    def ranges(self, origin: Pose2, headings_rad: Array) -> Array:
        """Distance (n,) along each heading in the world to the nearest wall; inf where there is none."""
        return self.cast(np.array([[origin.x_m, origin.y_m]]), headings_rad)

    def cast(self, origins: Array, headings_rad: Array) -> Array:
        """The same from one origin (1, 2) for all, or one for each heading (n, 2)."""
        directions = np.column_stack([np.cos(headings_rad), np.sin(headings_rad)])
        begins, along = self.walls[:, 0], self.walls[:, 1] - self.walls[:, 0]
        offset = begins[None] - origins[:, None]
        with np.errstate(divide="ignore", invalid="ignore"):
            across = directions[:, None, 0] * along[None, :, 1] - directions[:, None, 1] * along[None, :, 0]
            reach = (offset[:, :, 0] * along[None, :, 1] - offset[:, :, 1] * along[None, :, 0]) / across
            share = (offset[:, :, 0] * directions[:, None, 1] - offset[:, :, 1] * directions[:, None, 0]) / across
        met: Array = np.where((reach > 0.0) & (share >= 0.0) & (share <= 1.0), reach, np.inf).min(axis=1)
        return met

    def distances(self, points: Array) -> Array:
        """Distance (n,) of points (n, 2) to the nearest wall."""
        begins, along = self.walls[:, 0], self.walls[:, 1] - self.walls[:, 0]
        share = np.einsum("nsd,sd->ns", points[:, None] - begins, along) / (along**2).sum(axis=1)
        nearest = begins + np.clip(share, 0.0, 1.0)[:, :, None] * along
        gaps: Array = np.linalg.norm(points[:, None] - nearest, axis=2).min(axis=1)
        return gaps


ROOM = LineWorld(
    np.array(
        [
            [[-4.0, -3.0], [5.0, -3.0]],
            [[5.0, -3.0], [5.0, 4.0]],
            [[5.0, 4.0], [-4.0, 4.0]],
            [[-4.0, 4.0], [-4.0, -3.0]],
            [[-2.0, -1.0], [-1.4, -1.0]],
            [[-1.4, -1.0], [-1.4, -2.0]],
            [[3.0, -1.5], [3.8, -0.9]],
        ]
    )
)
CORRIDOR = LineWorld(np.array([[[-40.0, -1.0], [40.0, -1.0]], [[-40.0, 1.0], [40.0, 1.0]]]))
