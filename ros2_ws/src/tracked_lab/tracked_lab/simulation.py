"""The simulator as a scenario wants it."""

from collections.abc import Mapping
from typing import Any

from sim_bridge.physics_settings import PhysicsSettings
from sim_bridge.scene_settings import SceneSettings
from sim_bridge.simulator import Simulator, SimulatorSettings
from tracked_description import Robot
from tracked_lab.tuning import check_known, tuning_of
from tracked_types import Pose2

_LISTED = ("start_pose",)  # of SceneSettings, but a list is no tunable field
_MEANINGLESS = ("time_mode",)


def make_simulator(robot: Robot, parameters: Mapping[str, Any], moved: Pose2 | None = None) -> Simulator:
    """Simulator from the parameters of the sim_bridge node; pacing is meaningless here and is ignored.

    ``moved``: where the robot stands instead, in the frame of its start pose.

    Raises
    ------
    UnknownParameterError: if a parameter is not the simulator's.
    CheckedFileError, ValueError: if the world, its start or a value cannot be used.
    """
    check_known("sim_bridge", parameters, (PhysicsSettings, SimulatorSettings, SceneSettings), *_LISTED, *_MEANINGLESS)
    listed = {name: parameters[name] for name in _LISTED if name in parameters}
    scene = SceneSettings(**listed, **tuning_of(SceneSettings, parameters))
    world, start = scene.load()
    if moved is not None:
        start = start.compose(moved)
    return Simulator(
        robot,
        world,
        SimulatorSettings(
            physics=PhysicsSettings(**tuning_of(PhysicsSettings, parameters)),
            **tuning_of(SimulatorSettings, parameters),
        ),
        seed=scene.seed,
        start=start,
    )
