"""Seeded scenes and a closed loop over an ideal base, for tests and benchmarks. Plans never read this."""

import time
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tracked_navigation.band.band_result import ARRIVED, BandResult
from tracked_navigation.band.timed_elastic_band import TimedElasticBand
from tracked_types import Mover, Pose2, Twist2, to_nanoseconds

Array = NDArray[np.float64]
PERIOD_S = 0.2  # between two updates


@dataclass(frozen=True, slots=True)
class Scene:
    """path: (n, 3). points: (m, 2). movers: (j, 5) place and velocity at time 0, and radius."""

    path: Array
    points: Array
    movers: Array

    def movers_at(self, now_s: float) -> tuple[Mover, ...]:
        """The movers as a tracker would report them."""
        stamp = to_nanoseconds(now_s)
        return tuple(
            Mover(index, stamp, "map", row[:2] + now_s * row[2:4], row[2:4], 1e-3 * np.eye(4), float(row[4]))
            for index, row in enumerate(self.movers)
        )


@dataclass(frozen=True, slots=True)
class Moment:
    """One update: when, from where, what came of it, and the processor time it took."""

    now_s: float
    start: Pose2
    twist: Twist2
    result: BandResult
    cpu_s: float


def straight_path(length_m: float) -> Array:
    """Poses (n, 3) along x."""
    xs = np.linspace(0.0, length_m, max(2, round(length_m / 0.05) + 1))
    return np.column_stack([xs, np.zeros((len(xs), 2))])


def disc(x_m: float, y_m: float, radius_m: float, count: int = 24) -> Array:
    """Points (count, 2) on the edge of a disc, as a lidar has them from all sides."""
    angles = np.linspace(0.0, 2.0 * np.pi, count, endpoint=False)
    return np.column_stack([x_m + radius_m * np.cos(angles), y_m + radius_m * np.sin(angles)])


def corridor(half_width_m: float, length_m: float) -> Array:
    """Points of two walls along x."""
    xs = np.arange(-1.0, length_m + 2.0, 0.05)
    return np.vstack([np.column_stack([xs, np.full(len(xs), side * half_width_m)]) for side in (1.0, -1.0)])


def random_scene(seed: int, length_m: float = 7.0) -> Scene:
    """A corridor with one to three discs, and up to three movers that cross the robot's way about when it is there."""
    random = np.random.default_rng(seed)
    half_width = random.uniform(1.0, 2.2)
    points = [corridor(half_width, length_m)]
    for _ in range(random.integers(1, 4)):
        place = random.uniform(1.5, 6.0), random.uniform(-half_width, half_width)
        points.append(disc(*place, random.uniform(0.1, 0.35)))
    movers = []
    for _ in range(random.integers(1, 4)):
        speed, course = random.uniform(0.1, 0.6), random.uniform(-np.pi, np.pi)
        velocity = speed * np.array([np.cos(course), np.sin(course)])
        meeting = np.array([random.uniform(2.0, 6.0), random.uniform(-1.0, 1.0)])
        place = meeting - velocity * meeting[0] / 0.37
        if np.hypot(*place) > 1.0:
            movers.append([*place, *velocity, random.uniform(0.15, 0.35)])
    return Scene(straight_path(length_m), np.vstack(points), np.array(movers).reshape(-1, 5))


def benchmark_scene(seed: int) -> Scene:
    """Three discs beside the way through a corridor, and one mover that comes towards the robot."""
    random = np.random.default_rng(seed)
    shifts = random.uniform(-0.3, 0.3, 3)
    discs = [disc(2.2 + shifts[0], 0.45, 0.3), disc(4.1 + shifts[1], -0.75, 0.25), disc(5.9 + shifts[2], -0.5, 0.3)]
    mover = [7.6 + random.uniform(-0.8, 0.8), 0.4 + random.uniform(-0.2, 0.2), -0.3, 0.0, 0.25]
    return Scene(straight_path(7.0), np.vstack([corridor(1.5, 7.0), *discs]), np.array([mover]))


def hard_scene(seed: int) -> Scene:
    """An oncoming disc meets the robot beside a standing one: there is no room for both at once."""
    random = np.random.default_rng(seed)
    where = 3.0 + random.uniform(-0.4, 0.4)
    speed = random.uniform(0.2, 0.5)
    mover = [where + speed * (where / 0.37) + random.uniform(-0.5, 0.5), 0.0, -speed, 0.0, 0.3]
    return Scene(straight_path(7.0), np.vstack([corridor(1.1, 7.0), disc(where, 0.5, 0.35)]), np.array([mover]))


def driven(
    band: TimedElasticBand, scene: Scene, *, seed: int, seconds: float = 60.0, noise_m: float = 0.003
) -> Iterator[Moment]:
    """The moments of a drive along a scene until it arrives: every trajectory is followed exactly for one period, and
    the pose is then measured with noise."""
    random = np.random.default_rng(seed)
    band.forget()
    start, twist = Pose2(0.0, 0.0, 0.0), Twist2(0.0, 0.0)
    for index in range(round(seconds / PERIOD_S)):
        now = index * PERIOD_S
        stamp, movers = to_nanoseconds(now), scene.movers_at(now)
        began = time.thread_time()  # a stop watch; no decision depends on it
        result = band.update(start, twist, scene.path, scene.points, movers, stamp)
        yield Moment(now, start, twist, result, time.thread_time() - began)
        if result.kind == ARRIVED or result.trajectory is None:
            return
        states, inputs = result.trajectory.at(stamp, np.array([PERIOD_S]))
        start = Pose2(*(states[0] + noise_m * random.normal(size=3)).tolist())
        twist = Twist2(*inputs[0].tolist())
