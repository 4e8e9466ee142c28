"""Groups of scan points that the map does not explain."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Cluster:
    """Points (n, 2) that belong together, and the disc around what they show of it (m)."""

    points_m: Array
    centre_m: Array
    radius_m: float


def clusters_of(points: Array, *, gap_m: float, least_points: int, largest_m: float) -> tuple[Cluster, ...]:
    """Split points (n, 2), given in the order of their beams, wherever neighbours are more than ``gap_m`` apart.

    A full revolution has no first beam: the last group goes on with the first one if they touch. Groups of fewer than
    ``least_points`` are noise, groups wider than ``largest_m`` are walls that the map does not know.
    """
    if not len(points):
        return ()
    steps = np.hypot(*np.diff(points, axis=0).T)
    groups = np.split(np.arange(len(points)), np.flatnonzero(steps > gap_m) + 1)
    if len(groups) > 1 and np.hypot(*(points[groups[-1][-1]] - points[groups[0][0]])) <= gap_m:
        groups = [np.concatenate([groups[-1], groups[0]]), *groups[1:-1]]
    found = []
    for group in groups:
        if len(group) < least_points:
            continue
        members = points[group]
        # The face that is seen is an arc: its chord's middle lies nearer to the true centre than the points' mean.
        low, high = members.min(axis=0), members.max(axis=0)
        centre = 0.5 * (low + high)
        radius = float(np.hypot(*(members - centre).T).max())
        if 2.0 * radius <= largest_m:
            found.append(Cluster(members, centre, radius))
    return tuple(found)
