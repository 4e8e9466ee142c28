"""The plant that a run's conditions ask for."""

import math

from sim_bridge.scene_settings import SceneSettings
from tracked_description import Robot
from tracked_lab.conditions import Conditions
from tracked_lab.kinematic_ground import Ground
from tracked_lab.kinematic_plant import KinematicPlant
from tracked_lab.plant import Plant
from tracked_lab.tuning import NodeParameters, tuning_of
from tracked_navigation import PlayerSettings
from tracked_report.scenario import Scenario


def make_plant(scenario: Scenario, robot: Robot, parameters: NodeParameters, conditions: Conditions) -> Plant:
    """The plant of one run, on the ground that its seed and its conditions give it.

    The kinematic plant takes seed and start pose from the scenario; its ground has no shape, so that the rest of the
    world, and the suspension, mean nothing to it.

    Raises
    ------
    UnknownParameterError, CheckedFileError, ValueError: if scenario or conditions ask for what does not exist.
    """
    simulated = parameters.get("sim_bridge", {})
    begin_s = reference_begins_s(robot, parameters)
    if conditions.plant == "belts":
        # The physics engine is loaded by those alone who need it.
        from tracked_lab.belt_world import BeltWorld

        return BeltWorld(robot, simulated, scenario.faults, conditions, begin_s)
    if scenario.faults:
        raise ValueError("faults: the kinematic plant knows none; they belong to the plant called belts")
    listed = {"start_pose": simulated["start_pose"]} if "start_pose" in simulated else {}
    scene = SceneSettings(**listed, **tuning_of(SceneSettings, simulated))
    _, start = scene.load()
    ground = Ground.of_seed(scene.seed, conditions.slip_severity, conditions.obstacle, begin_s)
    return KinematicPlant(robot, scene.seed, ground, start)


def reference_begins_s(robot: Robot, parameters: NodeParameters) -> float:
    """When the trajectory player will begin to move its reference: a whole second after the first odometry."""
    settings = PlayerSettings(**tuning_of(PlayerSettings, parameters.get("trajectory_player", {})))
    return float(math.ceil(1.0 / robot.odometry.rate_hz + settings.start_delay_s))
