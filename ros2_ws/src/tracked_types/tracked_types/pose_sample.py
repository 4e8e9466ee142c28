"""Measured pose."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tracked_types.pose import Pose2


@dataclass(frozen=True, slots=True)
class PoseSample:
    """Pose of the base in ``frame_id`` at ``stamp_ns``, as somebody measured it; it may become known much later.

    covariance: (3, 3) over (x, y, yaw) in m, rad.
    """

    stamp_ns: int
    frame_id: str
    pose: Pose2
    covariance: NDArray[np.float64]
