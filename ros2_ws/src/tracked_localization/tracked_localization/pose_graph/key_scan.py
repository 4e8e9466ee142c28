"""Scans kept along the way, and the motion from each to the next."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tracked_types import Pose2, ScanPoints

Array = NDArray[np.float64]


@dataclass(slots=True)
class KeyScan:
    """One scan that is kept. pose: of the base in the map, as known now."""

    points: ScanPoints
    pose: Pose2


@dataclass(frozen=True, slots=True)
class Edge:
    """Pose of the kept scan ``end`` in the frame of ``start``; information: its inverse covariance (3, 3)."""

    start: int
    end: int
    pose: Pose2
    information: Array
