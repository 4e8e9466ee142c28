"""The trajectory a player plays: from a named shape or from a file, and only if the robot can drive it."""

from dataclasses import dataclass
from pathlib import Path

from tracked_description import Robot
from tracked_navigation.motion_limits import MotionLimits, find_violation
from tracked_navigation.shape_settings import ShapeSettings
from tracked_navigation.shapes import build_shape
from tracked_navigation.trajectory_file import load_trajectory
from tracked_types import Trajectory
from tracked_types.setting import check_settings, setting


class InfeasibleTrajectoryError(ValueError):
    """A trajectory cannot be driven; the text says what it asks and what the limit is."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ReferenceSettings:
    """Where the trajectory comes from and how much of the robot it may use."""

    trajectory_file: str = setting("", "CSV or YAML file to play instead of a named shape")
    limit_share: float = setting(
        0.85, "share of the robot's limits a reference may use; controllers need the rest", low=0.05, high=1.0
    )

    def __post_init__(self) -> None:
        check_settings(self)


@dataclass(frozen=True, slots=True)
class NamedTrajectory:
    """A trajectory in its own frame, counted from stamp 0, and what reports call it."""

    name: str
    trajectory: Trajectory


def make_reference(robot: Robot, settings: ReferenceSettings, shape: ShapeSettings) -> NamedTrajectory:
    """The trajectory that the settings ask for.

    Raises
    ------
    InfeasibleTrajectoryError: if a shape asks more of the robot than its limits times ``limit_share``.
    TrajectoryFileError: if a file cannot be read or driven; the text names the line or key.
    """
    limits = MotionLimits.from_robot(robot, settings.limit_share)
    if settings.trajectory_file:
        path = Path(settings.trajectory_file)
        return NamedTrajectory(path.stem, load_trajectory(path, limits))
    trajectory = build_shape(shape)
    violation = find_violation(trajectory, limits)
    if violation:
        at_s = float(trajectory.times_s[violation.index])
        raise InfeasibleTrajectoryError(
            f"{shape.shape}: {violation.reason} (at {at_s:.2f} s); slow it down or make it larger"
        )
    return NamedTrajectory(shape.shape, trajectory)
