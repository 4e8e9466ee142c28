"""Whether the robot follows its tracks, and how much of their motion the ground takes."""

import enum
from dataclasses import dataclass


class Grip(enum.Enum):
    """What comes of the belts' motion."""

    UNKNOWN = "the tracks bear no witness"
    HOLDS = "the robot follows its tracks"
    BLOCKED = "tracks turn, robot does not"


@dataclass(frozen=True, slots=True)
class Traction:
    """What is known of slip at one instant.

    witness: who says that the robot is blocked (scan, imu); reason: in words; both empty while it is not. lost_share:
    share of the belts' travel that the ground takes; its variance grows where nobody sees it. yaw_multiplier: yaw rate
    over ground per yaw rate of the belts on the present ground.
    """

    stamp_ns: int
    grip: Grip
    witness: str
    reason: str
    lost_share: float
    lost_share_variance: float
    yaw_multiplier: float
    yaw_multiplier_variance: float
