"""Reference trajectories: named shapes and files, and the player that hands them out piece by piece."""

from tracked_navigation.motion_limits import MotionLimits, Violation, find_violation
from tracked_navigation.reference import InfeasibleTrajectoryError, NamedTrajectory, ReferenceSettings, make_reference
from tracked_navigation.trajectory_player import Phase, PlayerOutput, PlayerSettings, TrajectoryPlayer

__all__ = [
    "InfeasibleTrajectoryError",
    "MotionLimits",
    "NamedTrajectory",
    "Phase",
    "PlayerOutput",
    "PlayerSettings",
    "ReferenceSettings",
    "TrajectoryPlayer",
    "Violation",
    "find_violation",
    "make_reference",
]
