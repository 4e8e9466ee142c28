"""What the navigator says about itself."""

import enum
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tracked_navigation.band import BandResult
from tracked_types import Mover, Pose2, Trajectory


class Outcome(enum.Enum):
    """How a request ended."""

    SUCCEEDED = "succeeded"
    CANCELLED = "cancelled"
    ABORTED = "aborted"


@dataclass(frozen=True, slots=True)
class Finished:
    """The end of a request.

    reason: in words, empty if it succeeded. nearest: the reachable place nearest to the goal in the map's frame, if
    there is no way to the goal itself. position_error_m, yaw_error_rad: to the goal as localised, NaN if not reached.
    """

    stamp_ns: int
    outcome: Outcome
    reason: str = ""
    nearest: tuple[float, float] | None = None
    position_error_m: float = float("nan")
    yaw_error_rad: float = float("nan")


@dataclass(frozen=True, slots=True)
class Progress:
    """How far a request is. pose: in the map's frame. left_m: of the way. left_s: at the usual speed. since_s: the
    request. waits: why the robot does not simply go on, in words."""

    pose: Pose2
    left_m: float
    left_s: float
    since_s: float
    replans: int
    goals_left: int
    waits: str


@dataclass(frozen=True, slots=True)
class NavigatorOutput:
    """What one instant brought about.

    reference: to be driven from the instant on, in the odometry's frame; None if nothing is to be driven. band: what it
    was made from, in the map's frame. path: (n, 3) the global path, where it is new.
    """

    stamp_ns: int
    reference: Trajectory | None = None
    band: BandResult | None = None
    path: NDArray[np.float64] | None = None
    movers: tuple[Mover, ...] = ()
    progress: Progress | None = None
    finished: Finished | None = None
