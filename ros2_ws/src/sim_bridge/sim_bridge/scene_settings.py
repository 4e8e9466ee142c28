"""Where a simulation takes place, and with which noise."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from sim_bridge.world import World, load_world
from tracked_types import Pose2
from tracked_types.setting import check_settings, setting

START_POSE = ("start_pose", (0.0, 0.0, 0.0), "x (m), y (m) and yaw (rad) in the world, for start: pose.")
"""Name, default and description of the one parameter that is a list: ``Parameter(*START_POSE)``."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SceneSettings:
    """World, start and seed of a simulation."""

    world: str = setting("flat", "Name of a packaged world, or the path of a world file.")
    start: str = setting("default", "Which of the world's start poses the robot stands at; pose: at start_pose.")
    seed: int = setting(0, "Seed of all sensor noise.", low=0)
    start_pose: Sequence[float] = START_POSE[1]

    def __post_init__(self) -> None:
        check_settings(self)
        numbers = self.start_pose
        if len(numbers) != 3 or not all(math.isfinite(number) for number in numbers):
            raise ValueError(f"SceneSettings.start_pose must be three finite numbers, got {numbers!r}")

    def load(self) -> tuple[World, Pose2]:
        """The world, and the pose in it that the robot starts from.

        Raises
        ------
        CheckedFileError: if the world cannot be used.
        ValueError: if it has no such start; the text lists those it has.
        """
        world = load_world(self.world)
        return world, Pose2(*self.start_pose) if self.start == "pose" else world.start(self.start)
