"""The simulator as a scenario wants it."""

from collections.abc import Mapping
from typing import Any

from sim_bridge.physics_settings import PhysicsSettings
from sim_bridge.simulator import Simulator, SimulatorSettings
from sim_bridge.world import load_world
from tracked_description import Robot
from tracked_lab.tuning import check_known, tuning_of
from tracked_types import Pose2

_NOT_SETTINGS = ("world", "start", "start_pose", "seed", "time_mode")


def make_simulator(robot: Robot, parameters: Mapping[str, Any]) -> Simulator:
    """Simulator from the parameters of the sim_bridge node; pacing is meaningless here and is ignored.

    Raises
    ------
    UnknownParameterError: if a parameter is not the simulator's.
    CheckedFileError, ValueError: if the world, its start or a value cannot be used.
    """
    check_known("sim_bridge", parameters, (PhysicsSettings, SimulatorSettings), *_NOT_SETTINGS)
    world = load_world(parameters.get("world", "flat"))
    name = parameters.get("start", "default")
    return Simulator(
        robot,
        world,
        SimulatorSettings(
            physics=PhysicsSettings(**tuning_of(PhysicsSettings, parameters)),
            **tuning_of(SimulatorSettings, parameters),
        ),
        seed=parameters.get("seed", 0),
        start=Pose2(*parameters["start_pose"]) if name == "pose" else world.start(name),
    )
