"""Output of the odometry filter."""

from dataclasses import dataclass

from tracked_types import Odometry, Slip


@dataclass(frozen=True, slots=True)
class Estimate:
    """Odometry and slip at one instant of the odometry's period grid."""

    odometry: Odometry
    slip: Slip
