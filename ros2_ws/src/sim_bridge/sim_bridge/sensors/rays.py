"""Rays through a Bullet world."""

import numpy as np
import pybullet
from numpy.typing import NDArray

Array = NDArray[np.float64]


def cast_rays(client: int, origins_m: Array, ends_m: Array) -> Array:
    """Share of the way from each origin to each end, (n, 3) in the world, at which something is hit; 1 is no hit.

    What rays see is decided by the bodies' collision groups (`bodies`): the robot is transparent.
    """
    # More threads gain nothing: the cost lies in handing the hits over to Python.
    hits = pybullet.rayTestBatch(origins_m.tolist(), ends_m.tolist(), numThreads=1, physicsClientId=client)
    return np.array([hit[2] for hit in hits])
